"""The same cushion, compiled."""

from typing import Annotated, ClassVar

import numpy as np
from pydantic import Field

from tangible_core import HapticSurface
from tangible_core.compiled import CompiledTouch
from tangible_core.plugins import ForceRenderer, Touch


class CompiledCushion(ForceRenderer):
    """The cushion as a compiled kernel: the same forces, and a path in a hundredth of the time."""

    uses_materials: ClassVar[bool] = False

    stiffness_n_per_m: Annotated[float, Field(gt=0, le=1e5)] = 800.0
    """Greatest stiffness, at `soft_m` and deeper."""
    soft_m: Annotated[float, Field(gt=0, le=0.1)] = 0.002
    """Depth over which the stiffness grows from zero."""

    def touch(self, surface: HapticSurface) -> Touch:
        """Return a new touch on this surface; compiled on first use, then loaded from disk."""
        from . import kernels  # imports numba, so here

        height_m = np.pad(surface.height_m, 1, mode="edge")
        width_m, length_m = surface.extent_m
        fixed = (height_m, width_m, length_m, self.stiffness_n_per_m, self.soft_m)
        return CompiledTouch(kernels.tick, fixed, stiffness=self.stiffness_n_per_m)
