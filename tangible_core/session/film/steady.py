"""Disparity that is steady in time: noise is averaged, and a change counts once it was seen twice."""

from typing import Any, NamedTuple, cast, final

import numpy as np
from jaxtyping import Float32

from ...data import DisparityMap

AVERAGED = 0.2
"""Share of a new value in what is kept, where it differs little: after five frames, two thirds are new."""
GATE_PX, GATE_SHARE = 1.0, 0.03
"""What differs by more is a change, not noise: pixels of the pictures, or a share of the range of a relative map."""
MOST_DOUBTS, MOST_MISSING = 2, 5
"""Frames: a value that is not seen for longer makes way for what is, whatever that is, or for the unknown."""
CUT_SHARE = 0.5
"""More of what is known changes at once at a cut to another scene."""


class Steadied(NamedTuple):
    """A map as it is felt, and whether another scene began with it."""

    disparity: DisparityMap
    cut: bool


@final
class Steady:
    """Maps of one film, one after the other, made steady.

    At each pixel a value that differs little from the one that is kept is averaged with it; one that differs more is
    taken when the next agrees with it, so that an error of one frame is never felt, and nothing drags a trail. Where it
    is unknown, the kept value stays for some frames. After two frames most of which differ from what is kept, all is
    taken as it is: a cut.
    """

    def __init__(self) -> None:
        self._kept = self._waiting = np.empty((0, 0), np.float32)
        self._doubts = np.empty((0, 0), np.uint8)
        self._gate = GATE_PX
        self._changed = False
        """Whether most of the frame before differed from what is kept."""

    def next(self, found: DisparityMap) -> Steadied:
        """The next map, as it is felt. The first, and one of another size, is taken as it is."""
        new = found.disparity_px
        if self._kept.shape != new.shape:
            return self._begun(found, cut=self._kept.size > 0)
        out, changed = self._stepped(new)
        if changed and self._changed:
            return self._begun(found, cut=True)
        self._changed = changed
        return Steadied(DisparityMap(out, found.confidence, found.unit), cut=False)

    def _begun(self, found: DisparityMap, cut: bool) -> Steadied:
        """Everything as this map has it."""
        new = found.disparity_px
        self._kept, self._waiting = new.copy(), np.full(new.shape, np.nan, np.float32)
        self._doubts = np.zeros(new.shape, np.uint8)
        self._gate, self._changed = _gate(found), False
        return Steadied(found, cut)

    def _stepped(self, new: Float32[np.ndarray, "h w"]) -> tuple[Float32[np.ndarray, "h w"], bool]:
        from . import steady_kernels

        out = np.empty_like(new)
        how = (np.float32(AVERAGED), np.float32(self._gate), MOST_DOUBTS, MOST_MISSING)
        changed, known = cast(Any, steady_kernels).step(new, self._kept, self._waiting, self._doubts, out, *how)
        return out, changed > CUT_SHARE * known


def _gate(found: DisparityMap) -> float:
    """What is more than noise, in the unit of this map."""
    if found.unit == "px":
        return GATE_PX
    known = found.disparity_px[np.isfinite(found.disparity_px)]
    return GATE_SHARE * float(np.ptp(known)) if known.size else GATE_SHARE
