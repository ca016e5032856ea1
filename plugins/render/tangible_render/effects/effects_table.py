"""The tables of a surface's materials, and of their textures, friction and damping, for kernels."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float64, Int32

from tangible_core.data import HapticSurface, Material
from tangible_render.haptic_textures import compile_textures
from tangible_render.haptic_textures.table import COUNT, DRAG, STIFFNESS

Table = Float64[np.ndarray, "n p"]
TEXTURE_COLUMNS = [COUNT, DRAG, STIFFNESS]
# The number of columns after those of a texture: k, b, mu_s and mu_d, as in `material_table`.
LAW_COLUMNS = 4
# The columns that add to a force law if any of them is not 0; -3 is b, -2 mu_s.
EFFECT_COLUMNS = [*TEXTURE_COLUMNS, -3, -2]
Row = tuple[float, float, float, float]
"""The stiffness in N/m, damping in N s/m, static and dynamic friction of a material."""


def effects_table(
    surface: HapticSurface, friction: bool = True, texture: bool = True, damping: bool = True
) -> tuple[Int32[np.ndarray, "h w"], Table]:
    """Return labels, and a row for each: its texture, then k, b, mu_s and mu_d; one cell and row if all are equal."""
    assert surface.labels is not None and surface.materials is not None
    rows = _rows(surface.materials, friction, texture, damping)
    present = np.flatnonzero(np.bincount(surface.labels.ravel()))
    # So are disabled effects. A texture that sticks and slips replaces its material's friction.
    rows[np.setdiff1d(np.arange(len(rows)), present)] = 0
    if (rows[present] == rows[present[0]]).all():
        return np.zeros((1, 1), np.int32), rows[present[:1]]
    return np.ascontiguousarray(surface.labels, np.int32), rows


def split_textures(
    surface: HapticSurface, friction: bool
) -> tuple[Int32[np.ndarray, "h w"], Float64[np.ndarray, "n 4"], Table, Float64[np.ndarray, "m"]] | None:
    """Split labels, the columns k, b, mu_s and mu_d, a table of textures, and their memory; None without texture."""
    if surface.labels is None or not surface.materials:
        return None
    labels, table = effects_table(surface, friction)
    if not table[:, TEXTURE_COLUMNS].any():
        return None
    with_friction = table[:, -LAW_COLUMNS:].copy()
    table[:, 1 - LAW_COLUMNS :] = 0
    return labels, with_friction, table, initial_memory()


def initial_memory() -> Float64[np.ndarray, "m"]:
    """Return the memory of a touch before its first tick."""
    from . import kernels

    memory = np.zeros(kernels.REMEMBERED)
    memory[kernels.WAS_X], memory[kernels.SLIDES] = np.nan, -1
    return memory


def _rows(materials: Sequence[Material], friction: bool, texture: bool, damping: bool) -> Table:
    textures = texture * compile_textures(materials)
    textures[:, STIFFNESS] *= friction
    has_friction = friction * (textures[:, STIFFNESS] == 0)
    law_columns = [
        (
            material.stiffness_n_per_m,
            damping * material.damping_n_s_per_m,
            with_friction * material.static_friction,
            with_friction * material.dynamic_friction,
        )
        for material, with_friction in zip(materials, has_friction, strict=True)
    ]
    return np.hstack([textures, np.reshape(law_columns, (-1, LAW_COLUMNS))])


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
