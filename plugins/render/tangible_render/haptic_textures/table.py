"""Materials as rows of numbers, for code that must not know Python."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float64

from tangible_core.data import Material

from .waves import WAVES, waves

COUNT, DRAG, STIFFNESS, DYNAMIC, SWING, PER_M = range(6)
"""Columns: number of waves; drag [N s/m]; of a friction that sticks and slips its bristle's stiffness [N/m] (0: there
is none), dynamic friction, share by which it swings about that, slips per metre."""
HEAD = 8
"""Columns before the waves, of which there are then fx, fy, amplitude and phase, WAVES of each (see `waves`)."""
MOST_SWING = 0.9
"""A friction that once came down to 0 would have to stay there to be passive."""


def compile_textures(materials: Sequence[Material]) -> Float64[np.ndarray, "n p"]:
    """One row a material, read-only: what `heights.texture_height` and `forces.texture_force` take.

    The bristle is as stiff as the material. A row with a bristle brings the whole of the material's friction: a
    renderer leaves its own out there.
    """
    table = np.zeros((len(materials), HEAD + 4 * WAVES))
    for row, material in zip(table, materials, strict=True):
        parts = waves(material)
        row[COUNT] = len(parts.phase)
        row[DRAG] = material.drag_n_s_per_m
        if material.texture == "stick-slip":
            excess = material.static_friction / material.dynamic_friction - 1
            row[STIFFNESS : PER_M + 1] = (
                material.stiffness_n_per_m, material.dynamic_friction, min(excess, MOST_SWING), 1 / material.grain_m,
            )  # fmt: skip
        for start, part in zip(range(HEAD, len(row), WAVES), parts, strict=True):
            row[start : start + len(part)] = part
    table.flags.writeable = False
    return table


def bristle_stiffness(table: Float64[np.ndarray, "n p"]) -> float:
    """Of a friction that sticks, at most, N/m: k mu_s / mu_d, the level at which its bristle starts; 0 without one."""
    return float(np.max(table[:, STIFFNESS] * (1 + table[:, SWING]), initial=0.0))
