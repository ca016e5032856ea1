"""The arrays of a film: three slots, each from one surface to the next, in shared memory or not."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float32, Float64, Int64

from ..surface.coefficients import tile_bounds
from .filter_kernels import fill_slot
from .playing import SLOTS, publish, slots

SPEED_M_PER_S = 0.1  # the greatest speed of any place of a surface, m/s: that of a hand
# The greatest change of the spring force on a hand at rest in a tick, N: more feels like a knock.
STEP_N = 0.08
DROPPED = 0
# The first index in `host_state` of a flag for each slot: 1 if it ends short of its frame.
SHORT = 1


class Slots(NamedTuple):
    """The whole state of a film: any process with these arrays can continue it."""

    pairs: Float32[np.ndarray, "3 h4 w4 2"]  # the coefficients of the first and the last surface of each slot
    tiles_m: Float32[np.ndarray, "3 r c 2"]
    ends_m: Float32[np.ndarray, "3 r c 2"]
    frames: Float64[np.ndarray, "3"]
    shared: Int64[np.ndarray, "2"]  # the slots that are played and published, see `playing`
    host_state: Int64[np.ndarray, "4"]  # the state of the showing process alone, see DROPPED and SHORT

    @classmethod
    def still(cls, coefficients: Float32[np.ndarray, "h4 w4"], count: int) -> "Slots":
        """Return the slots of a film at rest, at frame 0. count: ticks of a slot."""
        bounds = tile_bounds(coefficients)
        pairs = np.repeat(coefficients[None, :, :, None], SLOTS, axis=0).repeat(2, axis=3)
        tiles_m = np.repeat(bounds[None], SLOTS, axis=0)
        shared = np.array([0, count], np.int64)
        return cls(pairs, tiles_m, tiles_m.copy(), np.zeros(SLOTS), shared, np.zeros(SHORT + SLOTS, np.int64))

    def show(self, target: Float32[np.ndarray, "h4 w4"], frame: int, most_m: float, ends: np.ndarray) -> None:
        """Publish a slot from the end of the played one to this surface, by at most most_m anywhere; ends: scratch."""
        while True:
            current, next_slot = slots(self.shared)
            free = next(slot for slot in range(SLOTS) if slot not in (current, next_slot))
            np.copyto(ends, target)
            self._fill(free, current, ends, most_m)
            self.frames[free] = frame
            if publish(self.shared, current, next_slot, free):
                self.host_state[DROPPED] += current != next_slot and self.frames[next_slot] != frame
                return

    def _fill(self, free: int, current: int, ends: np.ndarray, most_m: float) -> None:
        """Fill a slot that begins at the end of another. `ends`: the target coefficients, then those at its end."""
        self.host_state[SHORT + free] = fill_slot(ends, self.pairs[current], self.pairs[free], most_m)
        self.ends_m[free] = bounds = tile_bounds(ends)
        begins, bounds_of_both = self.ends_m[current], self.tiles_m[free]
        np.maximum(bounds[..., 0], begins[..., 0], out=bounds_of_both[..., 0])
        np.minimum(bounds[..., 1], begins[..., 1], out=bounds_of_both[..., 1])

    @property
    def arrived(self) -> bool:
        """True if the slot published last ends at its target."""
        return not self.host_state[SHORT + slots(self.shared)[1]]
