"""The grey level as a force: the simplest force law."""

from typing import Annotated, ClassVar

import numpy as np
from pydantic import Field

from tangible_core.compiled import CompiledTouch
from tangible_core.data import HapticSurface
from tangible_core.plugins import ForceRenderer, Touch

from .surface.dequantise import grey_levels


class GreyLevel(ForceRenderer):
    """The baseline: on contact, a force straight up in proportion to brightness, F_z = white G / 255.

    G is the height of the cell under the tip in 256 steps, 0 on the base plane and 255 at the surface's highest point.
    The other force laws correct its faults: the force steps at the surface, however gentle the touch, and at the edges
    of cells; it is always along z, so that a slope does not push sideways; pressing deeper changes nothing; and the
    lowest ground cannot be felt at all.

    The surface ends at its extent; beyond it is free air.
    Source: the report "Tangible Images", sec. 4.3, F_z proportional to G(m, n).
    """

    uses_materials: ClassVar[bool] = False

    force_at_white_n: Annotated[float, Field(gt=0, allow_inf_nan=False)] = 3.0
    """Force on the highest point of the surface."""

    def touch(self, surface: HapticSurface) -> Touch:
        """Return a new touch on this surface; its kernel is compiled on the first use on a machine, then loaded."""
        from .kernels import grey_level as kernels

        heights = np.ascontiguousarray(surface.height_m, np.float32)
        arguments = (heights, grey_levels(heights), *map(float, surface.extent_m), self.force_at_white_n)
        return CompiledTouch(kernels.tick, arguments, stiffness=0.0)
