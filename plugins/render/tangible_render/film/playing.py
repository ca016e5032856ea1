"""The surface of a film in each tick: slots that two processes share without locks; import it inside a verb."""

# pyright: reportCallIssue=false

import numpy as np
from numba import float32, float64, int64, types
from numba.extending import intrinsic

from tangible_core.compiled import FRAME, KERNEL, RISE_M, inner, njit

from ..contact.approach import TOUCHING
from ..surface.spline import height

SLOTS = 3
STATE = 0  # the index in `shared` of the played and the published slot, see `state`
TICK = 1
SHARED = 2
MOVING_SURFACE = (
    types.Array(float32, 4, "C"),
    types.Array(float32, 4, "C"),
    float64[::1],
    int64[::1],
    float64,
    *[float64] * 4,
)
"""The numba types of a film kernel's first arguments, of which each slot has coefficients, bounds and a frame."""
MOVING = float64[::1]


@intrinsic
def _load(context, array, index):
    """Read a number of an int64 array with acquire order: all writes before its release are visible after."""

    def generate(context, builder, signature, arguments):
        data = context.make_array(signature.args[0])(context, builder, arguments[0]).data
        return builder.load_atomic(builder.gep(data, [arguments[1]]), "acquire", 8)

    return types.int64(array, types.int64), generate


@intrinsic
def _replace(context, array, index, old, value):
    """Replace a number of an int64 array atomically if it is the expected one; return True if it was."""

    def generate(context, builder, signature, arguments):
        data = context.make_array(signature.args[0])(context, builder, arguments[0]).data
        at = builder.gep(data, [arguments[1]])
        result = builder.cmpxchg(at, arguments[2], arguments[3], "acq_rel", "acquire")
        return builder.extract_value(result, 1)

    return types.boolean(array, types.int64, types.int64, types.int64), generate


@inner()
def state(current, published):
    """Return two slots as one number; both are equal where no slot is to follow."""
    return SLOTS * current + published


@njit(types.UniTuple(int64, 2)(int64[::1]), **KERNEL)
def slots(shared):
    """Return the slot that is played, and the slot that is published."""
    now = _load(shared, int64(STATE))
    return now // SLOTS, now % SLOTS


@njit(types.boolean(int64[::1], int64, int64, int64), **KERNEL)
def publish(shared, current, next_slot, next_one):
    """Publish a slot in place of another; return False if a tick has left the played slot meanwhile."""
    return _replace(shared, int64(STATE), state(current, next_slot), state(current, next_one))


@inner(forceinline=True)
def play(frames, shared, count, moving):
    """Return the slot of a tick, the position in the slot after it, 0..1, and the share passed in it."""
    # One slot is played, one may be published to come next, and the third is free for the host to write. STATE holds
    # their roles, and either side replaces it only if the other has not done so meanwhile (compare and swap). So a
    # published slot always begins with the last surface of the played one; the played slot is never written to; and
    # neither side waits: a tick that loses a race stays in its slot, and tries again in the next tick.
    now = _load(shared, int64(STATE))
    slot, following, tick = now // SLOTS, now % SLOTS, shared[TICK]
    if tick >= count and following != slot and _replace(shared, int64(STATE), now, state(following, following)):
        slot, tick = following, 0
    moving[RISE_M], moving[FRAME] = 0.0, frames[slot]
    if tick >= count:
        return slot, 1.0, 0.0
    shared[TICK] = tick + 1
    return slot, min((tick + 1) / count, 1.0), 1.0 / count


@inner(forceinline=True)
def write_rise(pairs, across_per_m, down_per_m, part, memory, moving):
    """Write to `moving` the rise of the surface at the proxy in this tick, m: its speed along z times the period."""
    if part > 0.0 and memory[7] == TOUCHING and not np.isnan(memory[2]):
        moving[RISE_M] = height((pairs, -part, part), across_per_m, down_per_m, memory[0], memory[1])
