"""A lateral force against the slope: texture on a device with two axes."""

from typing import Annotated, ClassVar

from pydantic import Field

from tangible_core.compiled import CompiledTouch
from tangible_core.data import HapticSurface
from tangible_core.plugins import ForceRenderer, Touch

from .surface.coefficients import spline_surface
from .surface.dequantise import Filter


class LateralGradient(ForceRenderer):
    """A lateral force in proportion to the slope, on contact at any depth: F = -K grad h; none along z.

    K is the weight of a ball rolling on the surface. The surface is a C2 spline; it ends at its extent; beyond it is
    free air. The force steps at the surface.
    Source: Minsky, Ouh-young, Steele, Brooks & Behensky, Feeling and seeing: issues in force display, I3D 1990.
    """

    uses_materials: ClassVar[bool] = False
    is_lateral: ClassVar[bool] = True

    force_per_slope_n: Annotated[float, Field(gt=0, allow_inf_nan=False)] = 2.0
    """Gain K: force on a slope of 1 m/m."""
    dequantise: Filter = "auto"
    """Smoothing of heights with 17 to 256 distinct values, such as 8-bit pictures have, by at most half a step: auto,
    never, or a standard deviation in cells."""

    def touch(self, surface: HapticSurface) -> Touch:
        """Return a new touch on this surface; its kernel is compiled on the first use on a machine, then loaded."""
        from .kernels import lateral as kernels

        arguments = (*spline_surface(surface, self.dequantise), self.force_per_slope_n, 0.0)
        return CompiledTouch(kernels.tick, arguments, stiffness=0.0)
