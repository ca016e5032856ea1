"""The compiled kernel of `proxy` on materials with a texture, on a moving surface. Imports numba."""

from numba import float64

from tangible_core.compiled import KERNEL, njit

from ..contact.spring import MATERIALS, MEMORY, spring_and_damper
from ..effects.kernels import effects, texture
from ..surface.bilinear import LABELS, NEWTONS
from .playing import MOVING, MOVING_SURFACE, play, write_rise
from .steady import STEADY, steady


@njit(NEWTONS(*MOVING_SURFACE, LABELS, MATERIALS, MEMORY, MATERIALS, MEMORY, STEADY, MOVING, *[float64] * 6), **KERNEL)
def moving_textured_tick(
    pairs, tiles_m, frames, shared, count, width_m, length_m, across_per_m, down_per_m, labels, table, memory, textures,
    contact, last, moving, x, y, z, vx, vy, vz,
):  # fmt: skip
    """Compute `kernels.proxy_texture.textured_tick` on the surface at the end of this tick."""
    slot, share, part = play(frames, shared, count, moving)
    shape = (pairs[slot], 1.0 - share, share), width_m, length_m, across_per_m, down_per_m
    label, t, tx, ty, dx, dy, dz = texture(labels, width_m, length_m, textures, contact, x, y, z)
    vz -= tx * vx + ty * vy
    fx, fy, fz = spring_and_damper(shape, tiles_m[slot], labels, table, memory, x, y, z - t, vx, vy, vz)
    write_rise(pairs[slot], across_per_m, down_per_m, part, memory, moving)
    fx, fy, fz = steady(last, moving, x, y, z - t, vx, vy, vz, fx, fy, fz)
    return effects(textures, label, 1.0, contact, tx, ty, dx, dy, dz, vx, vy, vz, fx, fy, fz)
