"""Penalty force straight up: the simplest spring."""

from collections.abc import Mapping
from typing import Annotated, ClassVar

from pydantic import Field

from tangible_core.compiled import CompiledTouch
from tangible_core.data import HapticSurface
from tangible_core.plugins import ForceRenderer, Touch

from .effects.effects_table import stiffness_table
from .surface.coefficients import spline_surface
from .surface.dequantise import Filter


class Penalty(ForceRenderer):
    """A spring along z: F_z = k d, d = h(x, y) - z the depth under the surface.

    For comparisons, and for devices that push along one axis. It has no friction; `proxy` holds the hand at walls.

    >>> import numpy as np
    >>> from tangible import HapticState, HapticSurface, Penalty, Relief
    >>> touch = Penalty(stiffness_n_per_m=500).touch(HapticSurface(Relief(np.zeros((8, 8), np.float32), (0.08, 0.08))))
    >>> touch.force(HapticState(position_m=(0, 0, -0.002)))
    Force(x=0.0, y=0.0, z=1.0)

    It has no lateral part, so that a slope shows by its height alone and does not push sideways, and it is not
    conservative: entering at a deep place and leaving at a shallow one generates energy. Damping acts along z, in
    contact only, and never pulls. The surface is a C2 spline; it ends at its extent; beyond it is free air.
    Source: Massie & Salisbury, The PHANToM haptic interface, ASME Winter Annual Meeting 1994.
    """

    expected_failures: ClassVar[Mapping[str, str]] = {
        "springs_are_exact": "its spring acts along z alone, on slopes too, where the normal leans away from z"
    }
    stiffness_n_per_m: Annotated[float, Field(gt=0, allow_inf_nan=False)] = 800.0
    """Stiffness, where the cell under the tip has no material."""
    damping_n_s_per_m: Annotated[float, Field(ge=0, allow_inf_nan=False)] = 0.0
    """Damping along z, in contact."""
    dequantise: Filter = "auto"
    """Smoothing of heights with 17 to 256 distinct values, such as 8-bit pictures have, by at most half a step: auto,
    never, or a standard deviation in cells."""

    def touch(self, surface: HapticSurface) -> Touch:
        """Return a new touch on this surface; its kernel is compiled on the first use on a machine, then loaded."""
        from .kernels import penalty as kernels

        shape = spline_surface(surface, self.dequantise)
        labels, stiffness = stiffness_table(surface, self.stiffness_n_per_m)
        arguments = (*shape, labels, stiffness, self.damping_n_s_per_m)
        return CompiledTouch(kernels.tick, arguments, stiffness=float(stiffness.max()))
