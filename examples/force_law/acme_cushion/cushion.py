"""A cushion, in plain Python."""

import math
from typing import Annotated, ClassVar

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
        self._surface = surface

    def force(self, state: HapticState) -> Force:
        """Return a force straight up where the tip is below the surface; zero in free air and beyond the picture."""
        x, y, z = state.position_m
        depth_m = self._surface.height_at(x, y) - z  # NaN beyond the picture
        soft_m = min(depth_m, self._soft_m)
        push_n = self._stiffness_n_per_m * (depth_m - soft_m + 0.5 * soft_m * soft_m / self._soft_m)
        return Force(0.0, 0.0, push_n) if depth_m > 0 and math.isfinite(push_n) else NO_FORCE
