"""The arrays of a film: three slots, each from one surface to the next, in the memory of whoever shares them."""

from typing import NamedTuple, cast

import numpy as np
from jaxtyping import Float32, Float64, Int64

from ..surface.tiles import tile_bounds

SPEED_M_PER_S = 0.1
"""No place of a surface moves faster: a hand does not."""
STEP_N = 0.08
"""Nor so fast that the spring on a hand at rest changes by more in a tick, which it would feel as a knock."""
SLOTS = 3
DROPPED, SHORT = 0, 1
"""In `told`: frames that were never gone to; and from SHORT on, for each slot, whether it ends short of its frame."""


class Slots(NamedTuple):
    """All that a film remembers: whoever has these arrays, in whichever process, goes on with it."""

    pairs: Float32[np.ndarray, "3 h4 w4 2"]
    """Coefficients of what each slot begins with and of what it ends with."""
    tiles_m: Float32[np.ndarray, "3 r c 2"]
    """Bounds of both, tile by tile: what a tick reads."""
    ends_m: Float32[np.ndarray, "3 r c 2"]
    """Bounds of what it ends with."""
    frames: Float64[np.ndarray, "3"]
    """The frame that each goes to."""
    shared: Int64[np.ndarray, "2"]
    """Which slot is played and which is published, see `playing`."""
    host_state: Int64[np.ndarray, "4"]
    """What only the one who shows writes and reads."""

    @classmethod
    def still(cls, coefficients: Float32[np.ndarray, "h4 w4"], count: int) -> "Slots":
        """A film that stands still, of frame 0. count: ticks that a slot takes."""
        bounds = tile_bounds(coefficients)
        pairs = np.repeat(coefficients[None, :, :, None], SLOTS, axis=0).repeat(2, axis=3)
        tiles_m = np.repeat(bounds[None], SLOTS, axis=0)
        shared = np.array([0, count], np.int64)
        return cls(pairs, tiles_m, tiles_m.copy(), np.zeros(SLOTS), shared, np.zeros(SHORT + SLOTS, np.int64))

    def show(self, target: Float32[np.ndarray, "h4 w4"], frame: int, most_m: float, ends: np.ndarray) -> None:
        """Go to this surface next, from where the slot that is played ends, by at most so much anywhere.

        ends: scratch of the same shape.
        """
        from .playing import publish

        while True:
            played, published = slots_of(self.shared)
            free = next(slot for slot in range(SLOTS) if slot not in (played, published))
            np.copyto(ends, target)
            self._fill(free, played, ends, most_m)
            self.frames[free] = frame
            if publish(self.shared, played, published, free):
                self.host_state[DROPPED] += played != published and self.frames[published] != frame
                return

    def _fill(self, free: int, played: int, ends: np.ndarray, most_m: float) -> None:
        """A slot that begins where another ends. `ends` are the wanted coefficients, and become what it ends with."""
        from .filter_kernels import fill_slot

        self.host_state[SHORT + free] = fill_slot(ends, self.pairs[played], self.pairs[free], most_m)
        self.ends_m[free] = bounds = tile_bounds(ends)
        begins, bounds_of_both = self.ends_m[played], self.tiles_m[free]
        np.maximum(bounds[..., 0], begins[..., 0], out=bounds_of_both[..., 0])
        np.minimum(bounds[..., 1], begins[..., 1], out=bounds_of_both[..., 1])

    @property
    def arrived(self) -> bool:
        """Whether what was published last ends where it was wanted."""
        return not self.host_state[SHORT + slots_of(self.shared)[1]]


def slots_of(shared: Int64[np.ndarray, "2"]) -> tuple[int, int]:
    """The slot that is played, and the one that is published."""
    from .playing import slots

    return cast("tuple[int, int]", slots(shared))
