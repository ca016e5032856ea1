"""A cushion, in plain Python."""

import math
from typing import Annotated, ClassVar

import numpy as np
from pydantic import Field

from tangible_core import Force, HapticState, HapticSurface
from tangible_core.data import NO_FORCE
from tangible_core.plugins import ForceRenderer, PlainTouch, Touch


class Cushion(ForceRenderer):
    """A spring along z that is soft at first: its stiffness grows with depth, up to a greatest one."""

    uses_materials: ClassVar[bool] = False

    stiffness_n_per_m: Annotated[float, Field(gt=0, le=1e5)] = 800.0
    """Greatest stiffness, at `soft_m` and deeper."""
    soft_m: Annotated[float, Field(gt=0, le=0.1)] = 0.002
    """Depth over which the stiffness grows from zero."""

    def touch(self, surface: HapticSurface) -> Touch:
        """Return a new touch on this surface."""
        return CushionTouch(surface, self.stiffness_n_per_m, self.soft_m)


class CushionTouch(PlainTouch):
    """The cushion on one surface."""

    def __init__(self, surface: HapticSurface, stiffness_n_per_m: float, soft_m: float) -> None:
        self.stiffness_n_per_m = self._stiffness_n_per_m = stiffness_n_per_m
        self._soft_m = soft_m
        self._height_m = np.pad(surface.height_m, 1, mode="edge")
        self._extent_m = surface.extent_m

    def force(self, state: HapticState) -> Force:
        """Return a force straight up where the tip is below the surface; zero in free air and beyond the picture."""
        (x, y, z), (width_m, length_m) = state.position_m, self._extent_m
        across, down = x / width_m + 0.5, 0.5 - y / length_m
        if not (0 <= across <= 1 and 0 <= down <= 1):
            return NO_FORCE
        depth_m = self._height(across, down) - z
        soft_m = min(depth_m, self._soft_m)
        push_n = self._stiffness_n_per_m * (depth_m - soft_m + 0.5 * soft_m * soft_m / self._soft_m)
        return Force(0.0, 0.0, push_n) if depth_m > 0 and math.isfinite(push_n) else NO_FORCE

    def _height(self, across: float, down: float) -> float:
        """Interpolate between the centres of the cells; level from the outermost centres to the edge."""
        rows, columns = self._height_m.shape
        row, column = 0.5 + down * (rows - 2), 0.5 + across * (columns - 2)
        i, j = int(row), int(column)
        (a, b), (c, d) = self._height_m[i : i + 2, j : j + 2].tolist()
        far, near = a + (column - j) * (b - a), c + (column - j) * (d - c)
        return far + (row - i) * (near - far)
