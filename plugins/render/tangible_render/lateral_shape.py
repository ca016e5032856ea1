"""A lateral force in proportion to the push: a shape on a flat table."""

from typing import Annotated, ClassVar

from pydantic import Field

from tangible_core.compiled import CompiledTouch
from tangible_core.data import HapticSurface
from tangible_core.plugins import ForceRenderer, Touch

from .surface.coefficients import spline_surface
from .surface.dequantise import Filter


class LateralShape(ForceRenderer):
    """A lateral force in proportion to slope and pressing force: F = -F_n grad h with F_n = k d; none along z.

    This is the force of a frictionless slope on a finger that pushes with F_n, without its vertical part: it feels like
    the shape even on a flat table, which supplies the force along z. k stands for how hard the hand pushes. The surface
    is a C2 spline; it ends at its extent; beyond it is free air.
    Source: Robles-De-La-Torre & Hayward, Force can overcome object geometry in the perception of shape through active
    touch, Nature 412 (2001).
    """

    uses_materials: ClassVar[bool] = False
    is_lateral: ClassVar[bool] = True

    stiffness_n_per_m: Annotated[float, Field(gt=0, allow_inf_nan=False)] = 800.0
    """Stiffness k that turns depth into the pressing force F_n."""
    dequantise: Filter = "auto"
    """Smoothing of heights with 17 to 256 distinct values, such as 8-bit pictures have, by at most half a step: auto,
    never, or a standard deviation in cells."""

    def touch(self, surface: HapticSurface) -> Touch:
        """Return a new touch on this surface; its kernel is compiled on the first use on a machine, then loaded."""
        from .kernels import lateral as kernels

        arguments = (*spline_surface(surface, self.dequantise), 0.0, self.stiffness_n_per_m)
        return CompiledTouch(kernels.tick, arguments, stiffness=self.stiffness_n_per_m)
