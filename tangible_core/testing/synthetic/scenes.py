"""Analytic scenes, whose disparity, segments or heights are known exactly, and which are the same in every run."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from jaxtyping import Float64, Int32, UInt8

from ...data import HapticSurface, Views

GREY, CONTRAST = 127.5, 40.0


@lru_cache
def wall(disparity_px: float = 6.0, shape: tuple[int, int] = (96, 320), seed: int = 0) -> Views:
    """Return views of a textured wall that faces both cameras: all pixels have one disparity, of either sign."""
    # A sum of plane waves 4 to 24 px long is exact at any fraction of a pixel.
    rows, columns = np.indices(shape, np.float64)
    return Views(_waves(rows, columns, seed), _waves(rows, columns + disparity_px, seed))


def two_textures(shape: tuple[int, int] = (96, 128)) -> tuple[UInt8[np.ndarray, "h w 3"], Int32[np.ndarray, "h w"]]:
    """Return a dark half with upright stripes 4 px apart, a bright one with slanting ones, and noise; the labels."""
    rows, columns = np.indices(shape, np.float64)
    labels = (columns >= shape[1] / 2).astype(np.int32)
    upright = 70 + 8 * np.cos(2 * np.pi * columns / 4)
    slanting = 180 + 8 * np.cos(2 * np.pi * (columns + rows) / 8)
    grey = np.where(labels == 0, upright, slanting) + np.random.default_rng(0).normal(0, 1, shape)
    return np.repeat(np.rint(grey).astype(np.uint8)[..., None], 3, axis=2), labels


@dataclass(frozen=True)
class KnownSurface:
    """A surface to touch, and the functions it was sampled from: metres in the workspace frame."""

    surface: HapticSurface
    height_m: Callable[[float, float], float]
    slope: Callable[[float, float], tuple[float, float]]

    def at(self, x_m: float, y_m: float, depth_m: float) -> tuple[float, float, float]:
        """Return the point this deep under the surface, measured straight down."""
        return x_m, y_m, self.height_m(x_m, y_m) - depth_m

    def normal(self, x_m: float, y_m: float) -> Float64[np.ndarray, "3"]:
        """Return the unit normal above (x, y), pointing out of the surface."""
        across, along = self.slope(x_m, y_m)
        return np.array((-across, -along, 1.0)) / np.sqrt(1 + across**2 + along**2)


@lru_cache
def plane(height_m: float = 0.01, shape: tuple[int, int] = (65, 65)) -> KnownSurface:
    """Return a level plane."""
    return ramp((0.0, 0.0), height_m, shape)


@lru_cache
def ramp(
    slope: tuple[float, float] = (0.2, 0.1), height_m: float = 0.015, shape: tuple[int, int] = (65, 65)
) -> KnownSurface:
    """Return a plane that rises by `slope` along x and y, this high in its middle."""
    return sample_surface(lambda x, y: height_m + slope[0] * x + slope[1] * y, lambda x, y: slope, shape)


@lru_cache
def sphere_cap(radius_m: float = 0.1, base_m: float = 0.08, shape: tuple[int, int] = (65, 65)) -> KnownSurface:
    """Return the part of a sphere more than `base_m` over its centre; its top is at the picture's centre."""

    def up(x: float, y: float) -> float:
        return float(np.sqrt(radius_m**2 - x**2 - y**2))

    return sample_surface(lambda x, y: up(x, y) - base_m, lambda x, y: (-x / up(x, y), -y / up(x, y)), shape)


def sample_surface(
    height_m: Callable[[float, float], float],
    slope: Callable[[float, float], tuple[float, float]],
    shape: tuple[int, int],
    width_m: float = 0.08,
) -> KnownSurface:
    """Sample a surface at the centres of square cells; the top row is far, at the largest y."""
    pitch = width_m / shape[1]
    x = (np.arange(shape[1]) + 0.5) * pitch - width_m / 2
    y = (shape[0] / 2 - np.arange(shape[0]) - 0.5) * pitch
    heights = np.array([[height_m(across, along) for across in x] for along in y])
    return KnownSurface(HapticSurface.from_heights(heights, width_m), height_m, slope)


def _waves(
    rows: Float64[np.ndarray, "h w"], columns: Float64[np.ndarray, "h w"], seed: int
) -> UInt8[np.ndarray, "h w 3"]:
    random = np.random.default_rng(seed)
    count = 24
    channels = [
        sum(
            np.cos(2 * np.pi * (np.cos(angle) * columns + np.sin(angle) * rows) / length + phase)
            for length, angle, phase in zip(
                np.geomspace(4, 24, count),
                random.uniform(0, np.pi, count),
                random.uniform(0, 2 * np.pi, count),
                strict=True,
            )
        )
        for _ in range(3)
    ]
    spread = np.sqrt(count / 2)
    return np.rint(np.clip(GREY + CONTRAST * np.stack(channels, axis=2) / spread, 0, 255)).astype(np.uint8)


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
