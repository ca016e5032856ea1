"""Penalty force along the gradient: a spring that stores the work of the hand."""

from typing import Annotated

import numpy as np
from pydantic import Field

from tangible_core.compiled import CompiledTouch
from tangible_core.data import HapticSurface
from tangible_core.plugins import ForceRenderer, Touch

from .effects.effects_table import stiffness_table


class PenaltyGradient(ForceRenderer):
    """A conservative spring along the surface's gradient: F = k d (-g, 1).

    d = h(x, y) - z is the depth under the surface, h the bilinear interpolant of the heights and g its exact
    gradient, so that F = -grad U with U = k d^2 / 2: where the stiffness is uniform, no closed path over it gains
    or loses energy. Not normalised: on a slope the stiffness along the normal is k (1 + |g|^2). Damping acts along the
    normal, in contact only, and never pulls. No friction.

    The surface ends at its extent; beyond it is free air. The force steps there under the surface, and where two
    materials of unequal stiffness meet.
    Source: the penalty method (reviewed in Zilles & Salisbury 1995), its direction that of the potential's gradient.
    """

    stiffness_n_per_m: Annotated[float, Field(gt=0, allow_inf_nan=False)] = 800.0
    """Stiffness on level ground, where the cell under the tip has no material."""
    damping_n_s_per_m: Annotated[float, Field(ge=0, allow_inf_nan=False)] = 0.0
    """Damping along the normal, in contact."""

    def touch(self, surface: HapticSurface) -> Touch:
        """Return a new touch on this surface; its kernel is compiled on the first use on a machine, then loaded."""
        from .kernels import penalty_gradient as kernels

        labels, stiffness = stiffness_table(surface, self.stiffness_n_per_m)
        heights = np.ascontiguousarray(surface.height_m, np.float32)
        arguments = (heights, labels, stiffness, *map(float, surface.extent_m), self.damping_n_s_per_m)
        return CompiledTouch(kernels.tick, arguments, stiffness=float(stiffness.max()))
