"""A lateral force in proportion to the push: a shape felt on a flat table."""

from typing import Annotated, ClassVar

from pydantic import Field

from tangible_core.compiled.touch import CompiledTouch
from tangible_core.data import HapticSurface
from tangible_core.plugins.interfaces import ForceRenderer, Touch

from .surface.coefficients import spline_surface
from .surface.dequantise import Filter


class LateralShape(ForceRenderer):
    """F = -F_n grad h in the plane, with F_n = k d for a hand d under the surface; nothing along z.

    What a frictionless slope does to a finger that pushes with F_n, less its lift: it is felt as the shape even on a
    flat table, which brings the force along z. k stands for how hard the hand pushes. The surface is a C2 spline; it
    ends at its extent: beyond it is free air.
    Source: Robles-De-La-Torre & Hayward, Force can overcome object geometry in the perception of shape through active
    touch, Nature 412 (2001).
    """

    uses_materials: ClassVar[bool] = False
    is_lateral: ClassVar[bool] = True

    stiffness_n_per_m: Annotated[float, Field(gt=0, allow_inf_nan=False)] = 800.0
    """k: how hard the hand is taken to push, for a depth of one metre."""
    dequantise: Filter = "auto"
    """Smooth heights of 17 to 256 values, such as 8 bits have, within half a step: auto, never, or a sigma in cells."""

    def touch(self, surface: HapticSurface) -> Touch:
        """A new touch on this surface; compiled on the first use on a machine, then loaded."""
        from . import lateral_kernels

        fixed = (*spline_surface(surface, self.dequantise), 0.0, self.stiffness_n_per_m)
        return CompiledTouch(lateral_kernels.tick, fixed, stiffness=self.stiffness_n_per_m)
