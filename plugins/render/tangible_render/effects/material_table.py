"""The table of a surface's materials for kernels: a row of numbers for each label."""

import numpy as np
from jaxtyping import Float64, Int32

from tangible_core.data import HapticSurface

Row = tuple[float, float, float, float]
"""The stiffness in N/m, damping in N s/m, static and dynamic friction of a material."""


def material_table(surface: HapticSurface, plain: Row) -> tuple[Int32[np.ndarray, "h w"], Float64[np.ndarray, "n 4"]]:
    """Return labels, and a row for each; one cell and one row where all are equal; plain: without materials."""
    if surface.labels is None or not surface.materials:
        return np.zeros((1, 1), np.int32), np.array([plain], np.float64)
    table = np.array(
        [
            (
                material.stiffness_n_per_m,
                material.damping_n_s_per_m,
                material.static_friction,
                material.dynamic_friction,
            )
            for material in surface.materials
        ],
        np.float64,
    )
    present = table[np.flatnonzero(np.bincount(surface.labels.ravel()))]
    if (present == present[0]).all():
        return np.zeros((1, 1), np.int32), present[:1]
    return np.ascontiguousarray(surface.labels, np.int32), table


def stiffness_table(
    surface: HapticSurface, plain_n_per_m: float
) -> tuple[Int32[np.ndarray, "h w"], Float64[np.ndarray, "n"]]:
    """Return the labels of `material_table`, and the stiffness of each, N/m."""
    labels, table = material_table(surface, (plain_n_per_m, 0.0, 0.0, 0.0))
    return labels, np.ascontiguousarray(table[:, 0])
