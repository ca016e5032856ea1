"""Materials as rows of numbers, for compiled code."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float64

from tangible_core.data import Material

from .waves import WAVES, waves

COUNT, DRAG, STIFFNESS, DYNAMIC, SWING, PER_M = range(6)
"""Columns: waves; drag [N s/m]; the bristle's stiffness [N/m] or 0, dynamic friction, its swing, slips per metre."""
HEAD = 8
"""Number of columns before the waves: fx, fy, amplitude and phase, WAVES of each (see `waves`)."""
MAX_SWING = 0.9
"""Largest swing: friction that reached 0 would have to stay there to be passive."""


def compile_textures(materials: Sequence[Material]) -> Float64[np.ndarray, "n p"]:
    """Compile materials to a read-only table, a row each, for `heights.texture_height` and `forces.texture_force`."""
    table = np.zeros((len(materials), HEAD + 4 * WAVES))
    for row, material in zip(table, materials, strict=True):
        parts = waves(material)
        row[COUNT] = len(parts.phase)
        row[DRAG] = material.drag_n_s_per_m
        if material.texture == "stick-slip":
            # A row with a bristle has all of the material's friction: a force law leaves its own out there.
            excess = material.static_friction / material.dynamic_friction - 1
            row[STIFFNESS : PER_M + 1] = (
                material.stiffness_n_per_m, material.dynamic_friction, min(excess, MAX_SWING), 1 / material.grain_m,
            )  # fmt: skip
        for start, part in zip(range(HEAD, len(row), WAVES), parts, strict=True):
            row[start : start + len(part)] = part
    table.flags.writeable = False
    return table


def bristle_stiffness(table: Float64[np.ndarray, "n p"]) -> float:
    """Return the largest stiffness of stick-slip friction, N/m: k mu_s / mu_d, its initial level; 0 without any."""
    return float(np.max(table[:, STIFFNESS] * (1 + table[:, SWING]), initial=0.0))
