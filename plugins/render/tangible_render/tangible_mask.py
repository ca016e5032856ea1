"""The tangible mask: the dark cells of a window pull the hand."""

from typing import Annotated, ClassVar

import numpy as np
from pydantic import AfterValidator, Field

from tangible_core.compiled import CompiledTouch
from tangible_core.data import HapticSurface
from tangible_core.plugins import ForceRenderer, Touch

from .surface.dequantise import grey_levels


def _odd(count: int) -> int:
    if count % 2 == 0:
        raise ValueError("the side of the mask must be an odd number of cells, so that it has a centre")
    return count


class TangibleMask(ForceRenderer):
    """A lateral pull to the darker, lower side: F = s sum (255 - I) (u, v) over the mask around the tip's cell.

    The method that the report hopes to improve on: for comparisons, and for devices that push sideways only. Heights
    are felt as pulls, so that walls do not hold the hand: take `proxy` to stroke a surface.

    (u, v) is a cell's offset from the middle, along x and y; I is the height in 256 steps, as in `grey-level` (in the
    source, a picture's Y = 0.3 R + 0.59 G + 0.11 B). The force acts on contact and is the same at any depth; it is zero
    where the mask leaves the surface. s makes a slope feel the same at any resolution: on a long straight edge from the
    base plane to the highest point the force is `force_at_edge_n`. A tick reads three summed-area tables at the mask's
    corners, for any size of the mask; they take 24 bytes a cell.
    Source: Vasudevan & Manivannan, Tangible images: runtime generation of haptic textures from images, IEEE Haptics
    Symposium 2008 (masks of 5, 17 and 65 cells).
    """

    uses_materials: ClassVar[bool] = False
    is_lateral: ClassVar[bool] = True

    mask_m: Annotated[float, Field(gt=0, allow_inf_nan=False)] = 0.005
    """Side of the square mask; rounded to an odd number of cells, at least 3."""
    mask_px: Annotated[int, Field(ge=3), AfterValidator(_odd)] | None = None
    """Side of the mask in cells instead, an odd number; the force then depends on the resolution."""
    force_at_edge_n: Annotated[float, Field(gt=0, allow_inf_nan=False)] = 2.0
    """Force on a straight edge from black to white."""

    def touch(self, surface: HapticSurface) -> Touch:
        """Return a new touch on this surface; its kernel is compiled on the first use on a machine, then loaded."""
        from .kernels import tangible_mask as kernels

        heights = np.ascontiguousarray(surface.height_m, np.float32)
        across_m, along_m = surface.relief.pitch_m
        columns, rows = self._cells(across_m), self._cells(along_m)
        scales = self._newtons(columns, rows, across_m), self._newtons(rows, columns, along_m)
        arguments = (heights, summed_tables(255 - grey_levels(heights)), *map(float, surface.extent_m))
        return CompiledTouch(kernels.tick, (*arguments, rows // 2, columns // 2, *scales), stiffness=0.0)

    def _cells(self, pitch_m: float) -> int:
        return self.mask_px or max(3, 2 * round((self.mask_m / pitch_m - 1) / 2) + 1)

    def _newtons(self, cells: int, others: int, pitch_m: float) -> float:
        """Return s: an edge through the middle sums to 255 others (cells^2 - 1) / 8, corrected for the rounded size."""
        side_m = cells * pitch_m if self.mask_px else self.mask_m
        return 8 * self.force_at_edge_n / (255 * others * cells * (cells**2 - 1)) * side_m / pitch_m


def summed_tables(dark: np.ndarray) -> np.ndarray:
    """Sum dark, dark x column and dark x row over all cells above and to the left (Crow 1984): (h + 1, w + 1, 3)."""
    rows, columns = dark.shape
    table = np.zeros((rows + 1, columns + 1, 3), np.int64)
    table[1:, 1:, 0] = dark
    table[1:, 1:, 1] = dark * np.arange(columns, dtype=np.int64)
    table[1:, 1:, 2] = dark * np.arange(rows, dtype=np.int64)[:, None]
    np.cumsum(table, axis=0, out=table)
    return np.cumsum(table, axis=1, out=table)
