"""Textures sampled as arrays of heights, for pictures and files."""

import numpy as np
from jaxtyping import Float32

from tangible_core.data import Material
from tangible_core.errors import MaterialError

from .waves import waves

FINEST = 3
"""Fewest pixels a period: a picture would show a finer wave as another one."""


def sample_tile(material: Material, width_m: float, pixels: int) -> Float32[np.ndarray, "n n"]:
    """Return heights over the mean, metres, of a square around the workspace's origin; the top row is far.

    Heights are those at the pixel centres. Waves that span fewer than 3 pixels along a row or a column are left out.
    Raises: MaterialError if width_m is not positive and finite, or pixels under 1.
    """
    if not (0 < width_m < np.inf and pixels >= 1):
        raise MaterialError(
            f"a tile needs a positive width and at least one pixel, not {width_m} m and {pixels} pixels"
        )
    pitch_m = width_m / pixels
    parts = waves(material)
    fine = np.maximum(np.abs(parts.fx), np.abs(parts.fy)) * pitch_m > 1 / FINEST
    amplitude_m = np.where(fine, 0, parts.amplitude_m)
    at_m = (np.arange(pixels) + 0.5) * pitch_m - width_m / 2
    across = 2 * np.pi * (np.outer(parts.fx, at_m) + parts.phase[:, None])
    away = 2 * np.pi * np.outer(at_m[::-1], parts.fy)
    even = np.einsum("ij,jk->ik", amplitude_m * np.cos(away), np.cos(across))
    odd = np.einsum("ij,jk->ik", amplitude_m * np.sin(away), np.sin(across))
    return (even - odd).astype(np.float32)
