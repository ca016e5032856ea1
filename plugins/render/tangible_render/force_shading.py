"""Force shading: facets feel round, as shaded facets look round."""

from typing import Annotated

import numpy as np
from pydantic import Field

from tangible_core.compiled import CompiledTouch
from tangible_core.data import HapticSurface
from tangible_core.plugins import ForceRenderer, Touch
from tangible_core.scene import normals

from .effects.effects_table import stiffness_table


class ForceShading(ForceRenderer):
    """A spring along the interpolated normal of a faceted (bilinear) surface: F = k d_n n.

    d_n = d / sqrt(1 + |g|^2) is the depth under the facet, d the depth straight down and g the facet's gradient; n is
    the unit normal, bilinear between those at the cells' centres (from central differences). So the direction is
    continuous where facets meet; the magnitude is not quite, and the force has no potential: it may generate energy.
    The surface ends at its extent; beyond it is free air.
    Source: Morgenbesser & Srinivasan, Force shading for haptic shape perception, ASME Dynamic Systems 58 (1996).
    """

    stiffness_n_per_m: Annotated[float, Field(gt=0, allow_inf_nan=False)] = 800.0
    """Stiffness, where the cell under the tip has no material."""

    def touch(self, surface: HapticSurface) -> Touch:
        """Return a new touch on this surface; its kernel is compiled on the first use on a machine, then loaded."""
        from .kernels import force_shading as kernels

        heights = np.ascontiguousarray(surface.height_m, np.float32)
        out = np.ascontiguousarray(np.moveaxis(normals(surface.relief), 2, 0))
        labels, stiffness = stiffness_table(surface, self.stiffness_n_per_m)
        arguments = (heights, out, labels, stiffness, *map(float, surface.extent_m))
        return CompiledTouch(kernels.tick, arguments, stiffness=float(stiffness.max()))
