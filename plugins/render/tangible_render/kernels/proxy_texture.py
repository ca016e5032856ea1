"""The compiled kernel of `proxy` on materials with a texture. Imports numba: imported inside `touch`."""

from numba import float64

from tangible_core.compiled import KERNEL, njit

from ..contact.spring import MATERIALS, MEMORY, SURFACE, spring_and_damper
from ..effects.kernels import effects, texture
from ..surface.bilinear import LABELS, NEWTONS


@njit(NEWTONS(*SURFACE, LABELS, MATERIALS, MEMORY, MATERIALS, MEMORY, *[float64] * 6), **KERNEL)
def textured_tick(
    coefficients, width_m, length_m, across_per_m, down_per_m, tiles_m, labels, table, memory, textures, contact,
    x, y, z, vx, vy, vz,
):  # fmt: skip
    """Compute `proxy.tick` under the textures of the materials; see `effects.kernels` for table and contact."""
    shape = coefficients, width_m, length_m, across_per_m, down_per_m
    label, t, tx, ty, dx, dy, dz = texture(labels, width_m, length_m, textures, contact, x, y, z)
    vz -= tx * vx + ty * vy
    fx, fy, fz = spring_and_damper(shape, tiles_m, labels, table, memory, x, y, z - t, vx, vy, vz)
    return effects(textures, label, 1.0, contact, tx, ty, dx, dy, dz, vx, vy, vz, fx, fy, fz)
