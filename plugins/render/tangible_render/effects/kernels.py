"""The compiled wrapper of a force law: a fine texture on its surface, friction, and damping; import it in a verb."""

import math

import numpy as np

from tangible_core.compiled import KERNEL, inner, njit
from tangible_render.haptic_textures.forces import STATE, texture_force
from tangible_render.haptic_textures.heights import texture_height
from tangible_render.haptic_textures.table import COUNT, DRAG, HEAD, WAVES
from tangible_render.haptic_textures.table import STIFFNESS as STICKS

from ..contact.approach import LEAP_M
from ..surface.bilinear import bilinear, cell, over

STIFFNESS, DAMPING, STATIC, DYNAMIC = range(HEAD + 4 * WAVES, HEAD + 4 * WAVES + 4)
# Places in a touch's memory: the law's last hand, x NaN without; way; bristle; 1 sliding, 0 sticking, -1 free.
WAS_X, WAS_Y, WAS_Z, WAY_X, WAY_Y, BRISTLE_X, BRISTLE_Y, SLIDES = range(STATE, STATE + 8)
REMEMBERED = STATE + 8


@njit(**KERNEL)
def tick(fixed, law, labels, width_m, length_m, table, bristle, memory, x, y, z, vx, vy, vz):
    """Wrap a law, whose force is the push of the surface, by its arguments and address; bristle: sticking stiffness."""
    label, t, tx, ty, dx, dy, dz = texture(labels, width_m, length_m, table, memory, x, y, z)
    # The texture is a height t(x, y) on top of the force law's surface. The law sees a hand at (x, y, z - t), and its
    # force G there becomes (G_x - t_x G_z, G_y - t_y G_z, G_z). Both do the same work: a law that generates no energy
    # generates none through a texture. Friction and damping are added to G and only take energy.
    vz -= tx * vx + ty * vy
    fx, fy, fz = law(*fixed, x, y, z - t, vx, vy, vz)
    return effects(table, label, bristle, memory, tx, ty, dx, dy, dz, vx, vy, vz, fx, fy, fz)


@njit(**KERNEL)
def lateral_tick(fixed, law, height_m, labels, width_m, length_m, table, bristle, memory, x, y, z, vx, vy, vz):
    """Wrap a lateral force law: the push for texture and friction is k d, d the depth under the cells."""
    label, t, tx, ty, dx, dy, _ = texture(labels, width_m, length_m, table, memory, x, y, z)
    fx, fy, fz = law(*fixed, x, y, z - t, vx, vy, vz - tx * vx - ty * vy)
    push = 0.0
    if over(width_m, length_m, x, y) and np.isfinite(vx + vy + vz):
        push = table[label, STIFFNESS] * max(bilinear(height_m, width_m, length_m, x, y)[0] + t - z, 0.0)
    along, aside = _friction(table, label, bristle, memory, dx, dy, vx, vy, push)
    fx, fy = fx + along - tx * push, fy + aside - ty * push
    return (fx, fy, fz) if np.isfinite(fx + fy + fz) else (0.0, 0.0, 0.0)


@inner(forceinline=True)
def texture(labels, width_m, length_m, table, memory, x, y, z):
    """Return (label, t, t_x, t_y, dx, dy, dz): the label under or nearest to the hand, its texture, the hand's step."""
    at_x = x if abs(x) <= 0.5 * width_m else math.copysign(0.5 * width_m, x)  # finite for NaN, too
    at_y = y if abs(y) <= 0.5 * length_m else math.copysign(0.5 * length_m, y)
    row, column = cell(labels.shape[0], labels.shape[1], width_m, length_m, at_x, at_y)
    label = labels[row, column]
    # The speed of a wave comes from this step, at any rate of the servo. dz is the step as the force law sees it.
    dx, dy, dz = x - memory[WAS_X], y - memory[WAS_Y], z - memory[WAS_Z]
    continues = dx * dx + dy * dy + dz * dz <= LEAP_M * LEAP_M
    if not continues:
        dx, dy = 0.0, 0.0
        _release(memory)
    t, tx, ty = 0.0, 0.0, 0.0
    if table[label, COUNT] > 0.0:
        t, tx, ty = texture_height(table, label, x, y, dx, dy, 1.0)
    dz = dz - t if continues else 0.0
    memory[WAS_X], memory[WAS_Y], memory[WAS_Z] = x, y, z - t
    return label, t, tx, ty, dx, dy, dz


@inner(forceinline=True)
def effects(table, label, bristle, memory, tx, ty, dx, dy, dz, vx, vy, vz, fx, fy, fz):
    """Add friction, the texture's own forces and damping to a force, and transform it by the texture's slope."""
    push = math.sqrt(fx * fx + fy * fy + fz * fz)
    acts = table[label, DRAG] + table[label, STICKS] + table[label, DAMPING] + table[label, STATIC] > 0.0
    if not (acts and 0.0 < push < math.inf):
        _release(memory)
        fx, fy = fx - tx * fz, fy - ty * fz
        return (fx, fy, fz) if np.isfinite(fx + fy + fz) else (0.0, 0.0, 0.0)
    inverse = 1.0 / push
    nx, ny, nz = inverse * fx, inverse * fy, inverse * fz
    # Two unit vectors across: Duff et al., Building an orthonormal basis, revisited, JCGT 6(1), 2017. The sign
    # matters only for a force straight down, which no force law has.
    sign = math.copysign(1.0, nz)
    a = -1.0 / (sign + nz)
    ax, ay, az = 1.0 + sign * nx * nx * a, sign * nx * ny * a, -sign * nx
    bx, by, bz = nx * ny * a, sign + ny * ny * a, -ny
    way_x, way_y = ax * dx + ay * dy + az * dz, bx * dx + by * dy + bz * dz
    speed_x, speed_y = ax * vx + ay * vy + az * vz, bx * vx + by * vy + bz * vz
    along, aside = _friction(table, label, bristle, memory, way_x, way_y, speed_x, speed_y, push)
    damper = min(table[label, DAMPING] * (nx * vx + ny * vy + nz * vz), push)
    fz += along * az + aside * bz - damper * nz
    fx += along * ax + aside * bx - damper * nx - tx * fz
    fy += along * ay + aside * by - damper * ny - ty * fz
    return (fx, fy, fz) if np.isfinite(fx + fy + fz) else (0.0, 0.0, 0.0)


@inner(forceinline=True)
def _release(memory):
    for i in range(WAS_X):
        memory[i] = 0.0
    for i in range(WAY_X, memory.size):
        memory[i] = 0.0
    memory[SLIDES] = -1.0


@inner(forceinline=True)
def _friction(table, label, bristle, memory, dx, dy, vx, vy, push):
    """Return lateral newtons after a step (dx, dy) along the surface at (vx, vy) m/s: friction and texture forces."""
    if not push > 0.0:
        _release(memory)
        return 0.0, 0.0
    if memory[SLIDES] < 0.0:
        dx, dy = 0.0, 0.0
    memory[WAY_X] += dx
    memory[WAY_Y] += dy
    fx, fy = texture_force(table, label, memory, memory[WAY_X], memory[WAY_Y], vx, vy, push)
    static, dynamic = table[label, STATIC], table[label, DYNAMIC]
    # Friction is a bristle: it sticks while its pull is within the static cone (the dynamic one if it slides already),
    # and slides on the dynamic one. For any path, push and rotation of the surface it stores no more energy than it was
    # given, as it is only rotated or shortened (Hayward & Armstrong, Experimental Robotics VI, 2000).
    zx, zy, slides = 0.0, 0.0, False
    if static > 0.0:
        zx, zy = memory[BRISTLE_X] + dx, memory[BRISTLE_Y] + dy
        pull = bristle * math.sqrt(zx * zx + zy * zy)
        slides = pull > (dynamic if memory[SLIDES] > 0.0 else static) * push
        if slides:
            shorter = dynamic * push / pull
            zx, zy = shorter * zx, shorter * zy
    memory[BRISTLE_X], memory[BRISTLE_Y], memory[SLIDES] = zx, zy, 1.0 if slides else 0.0
    return fx - bristle * zx, fy - bristle * zy
