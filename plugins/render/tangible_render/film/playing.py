"""Which surface a tick feels of a film: slots that two processes share without waiting for each other; compiled.

There are three slots, each with a surface to begin with and one to end with. One is played, one may be published to
come next, and the third is free for the host to write. Which is which stands in one number, STATE, that either side
replaces only if the other has not meanwhile. So a slot that is published always begins with what the one that is played
ends with, and the surface goes on exactly from there; what is played is never written to; and nobody waits: a tick that
loses a race plays on where it is, and tries again in the next.
Imports numba: a method imports this module inside its verb.
"""

# ruff: noqa: ANN001, ANN201, ANN202 -- the types are those that numba infers
# pyright: basic, reportCallIssue=false

import numpy as np
from numba import float32, float64, int64, njit, types
from numba.extending import intrinsic

from tangible_core.compiled.compiling import KERNEL, inner
from tangible_core.compiled.touch import FRAME, RISE_M

from ..contact.approach import TOUCHING
from ..surface.spline import height

SLOTS = 3
STATE, TICK = 0, 1
"""In `shared`: the slot that is played and the one that is published, see `state`; how many ticks it was played."""
SHARED = 2
MOVING_SURFACE = (
    types.Array(float32, 4, "C"),
    types.Array(float32, 4, "C"),
    float64[::1],
    int64[::1],
    float64,
    *[float64] * 4,
)
"""Types of what a kernel of a film is given first: `pairs`, `tiles_m`, `frames`, `shared`, the ticks of a slot, and the
surface's extent and cells. SLOTS times: pairs of coefficients (h, w, 2), bounds of both, the frame that it goes to."""
MOVING = float64[::1]


@intrinsic
def _load(context, array, index):
    """A number of an int64 array, such that all that was written before it is seen from here on."""

    def generate(context, builder, signature, arguments):
        data = context.make_array(signature.args[0])(context, builder, arguments[0]).data
        return builder.load_atomic(builder.gep(data, [arguments[1]]), "acquire", 8)

    return types.int64(array, types.int64), generate


@intrinsic
def _replace(context, array, index, expected, value):
    """Whether a number of an int64 array was the known one, and is now this: at once, for whoever else does so."""

    def generate(context, builder, signature, arguments):
        data = context.make_array(signature.args[0])(context, builder, arguments[0]).data
        at = builder.gep(data, [arguments[1]])
        done = builder.cmpxchg(at, arguments[2], arguments[3], "acq_rel", "acquire")
        return builder.extract_value(done, 1)

    return types.boolean(array, types.int64, types.int64, types.int64), generate


@inner()
def state(played, published):
    """Two slots as one number; both are the same where nothing is to come."""
    return SLOTS * played + published


@njit(types.UniTuple(int64, 2)(int64[::1]), **KERNEL)
def slots(shared):
    """The slot that is played, and the one that is published."""
    now = _load(shared, int64(STATE))
    return now // SLOTS, now % SLOTS


@njit(types.boolean(int64[::1], int64, int64, int64), **KERNEL)
def publish(shared, played, published, next_one):
    """Whether a slot was published in the place of another: not if a tick has left the one that was played."""
    return _replace(shared, int64(STATE), state(played, published), state(played, next_one))


@inner(forceinline=True)
def play(frames, shared, count, moving):
    """For a tick: which slot it plays, where it is in it after this tick, 0..1, and how much of it passes in it."""
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
def write_rise(pairs, across_per_m, down_per_m, passed, memory, moving):
    """How much the surface rose at the proxy in this tick, written to what the touch tells."""
    if passed > 0.0 and memory[7] == TOUCHING and not np.isnan(memory[2]):
        moving[RISE_M] = height((pairs, -passed, passed), across_per_m, down_per_m, memory[0], memory[1])
