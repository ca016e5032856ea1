"""Further surfaces whose heights and slopes are known exactly: waves, a ridge, a cone and a cliff."""

from functools import lru_cache

import numpy as np

from .scenes import KnownSurface, sample_surface


@lru_cache
def waves(amplitude_m: float = 0.004, wavelength_m: float = 0.02, shape: tuple[int, int] = (256, 256)) -> KnownSurface:
    """Return an egg box: h = A + A sin(2 pi x / L) sin(2 pi y / L), with slopes up to 2 pi A / L."""
    k = 2 * np.pi / wavelength_m
    return sample_surface(
        lambda x, y: amplitude_m * float(1 + np.sin(k * x) * np.sin(k * y)),
        lambda x, y: (
            amplitude_m * k * float(np.cos(k * x) * np.sin(k * y)),
            amplitude_m * k * float(np.sin(k * x) * np.cos(k * y)),
        ),
        shape,
    )


@lru_cache
def ridge(slope: float = 0.5, top_m: float = 0.03, shape: tuple[int, int] = (256, 256)) -> KnownSurface:
    """Return two planes that meet in a sharp edge along y."""
    return sample_surface(lambda x, y: top_m - slope * abs(x), lambda x, y: (-slope * float(np.sign(x)), 0.0), shape)


@lru_cache
def cone(slope: float = 0.5, top_m: float = 0.04, shape: tuple[int, int] = (256, 256)) -> KnownSurface:
    """Return a cone with its tip over the centre."""

    def gradient(x: float, y: float) -> tuple[float, float]:
        radius = float(np.hypot(x, y)) or 1.0
        return -slope * x / radius, -slope * y / radius

    return sample_surface(lambda x, y: top_m - slope * float(np.hypot(x, y)), gradient, shape)


@lru_cache
def cliff(high_m: float = 0.004, shape: tuple[int, int] = (256, 256)) -> KnownSurface:
    """Return level ground that steps up by `high_m` at x = 0."""
    return sample_surface(lambda x, y: high_m * float(x > 0), lambda x, y: (0.0, 0.0), shape)
