"""A temporal filter of disparity: it averages noise, and adopts a change once two frames agree on it."""

from typing import Any, NamedTuple, cast, final

import numpy as np
from jaxtyping import Float32

from ...data import DisparityMap

# Weight of a new value in the average, where it differs little: after five frames, two thirds are new.
AVERAGED = 0.2
# Threshold between noise and change: pixels of the pictures, or a share of the range of a relative map.
GATE_PX, GATE_SHARE = 1.0, 0.03
# Greatest number of frames for which a value is kept while other values, or none, are seen in its place.
MAX_DOUBTS, MAX_MISSING = 2, 5
# Share of the known pixels above which a simultaneous change is a cut to another scene.
CUT_SHARE = 0.5


class FilteredMap(NamedTuple):
    """A filtered map, and whether another scene began with it."""

    disparity: DisparityMap
    cut: bool


@final
class Steady:
    """A temporal filter for the maps of one film.

    At each pixel, a value that differs little from the kept one is averaged with it; a value that differs more is
    adopted when the next one agrees, so that an error of one frame has no effect and no change leaves a trail. Where
    the value is unknown, the kept one stays for some frames. After two frames of which most pixels differ from the kept
    ones, the whole map is adopted: a cut.
    """

    def __init__(self) -> None:
        self._values = self._waiting = np.empty((0, 0), np.float32)
        self._doubts = np.empty((0, 0), np.uint8)
        self._gate = GATE_PX
        self._is_changed = False
        """True if most of the frame before differed from the kept values."""

    def next(self, disparity: DisparityMap) -> FilteredMap:
        """Filter the next map. The first one, and one of another size, is adopted as it is."""
        new = disparity.disparity_px
        if self._values.shape != new.shape:
            return self._restart(disparity, cut=self._values.size > 0)
        out, is_changed = self._step(new)
        if is_changed and self._is_changed:
            return self._restart(disparity, cut=True)
        self._is_changed = is_changed
        return FilteredMap(DisparityMap(out, disparity.confidence, disparity.unit), cut=False)

    def _restart(self, disparity: DisparityMap, cut: bool) -> FilteredMap:
        new = disparity.disparity_px
        self._values, self._waiting = new.copy(), np.full(new.shape, np.nan, np.float32)
        self._doubts = np.zeros(new.shape, np.uint8)
        self._gate, self._is_changed = _gate(disparity), False
        return FilteredMap(disparity, cut)

    def _step(self, new: Float32[np.ndarray, "h w"]) -> tuple[Float32[np.ndarray, "h w"], bool]:
        from . import steady_kernels

        out = np.empty_like(new)
        how = (np.float32(AVERAGED), np.float32(self._gate), MAX_DOUBTS, MAX_MISSING)
        changes, count = cast(Any, steady_kernels).step(new, self._values, self._waiting, self._doubts, out, *how)
        return out, changes > CUT_SHARE * count


def _gate(disparity: DisparityMap) -> float:
    """Return the threshold between noise and change, in the unit of this map."""
    if disparity.unit == "px":
        return GATE_PX
    values = disparity.disparity_px[np.isfinite(disparity.disparity_px)]
    return GATE_SHARE * float(np.ptp(values)) if values.size else GATE_SHARE
