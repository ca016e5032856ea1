"""Choosing what to compare by trying it on a part of the picture.

No noise model is needed. A wrong match that passes the left-right check is seldom confirmed by its neighbours, so the
share of checked pixels that the speckle filter erases (the loss) tells how far a cost can be trusted, whatever the
cause: noise, compression, or rows that do not correspond. The strips already swept are kept when all is well, so that a
clean pair pays next to nothing.
"""

import logging
from collections.abc import Sequence

import numpy as np

from .costs import HEAVY, LIGHT, SHARP, Cost
from .notes import note
from .pairs import Pair
from .row_offset import realigned, row_offset
from .search_range import find_range
from .span import UNKNOWN, Span
from .speckles import remove_speckles
from .strips import Swept, blank, sweep

log = logging.getLogger(__name__)
DOUBT, NOISE = 0.06, 0.20
"""Loss from which the light and the heavy cost are taken."""
LEAST_OFFSET_PX = 0.3
"""Smaller offsets of rows are left alone."""
SAMPLE_ROWS = 64
"""Rows of a strip that the loss and the offset are measured on."""
Rows = Sequence[tuple[int, int]]


def match(pair: Pair, span: Span, cost: Cost | None, tolerance: float, realign: bool, rows: Rows) -> tuple[Swept, Cost]:
    """The strips `rows` matched, with the given cost or, if None, with the one that the pair calls for."""
    trial = _Trial(pair, span, cost or SHARP, tolerance)
    if cost and not realign:
        trial.sweep(rows)
        return trial.out, cost
    probes = _spread(rows)
    loss = trial.loss(probes)
    offset = _offset(trial, probes, loss) if realign else 0.0
    if abs(offset) > LEAST_OFFSET_PX:
        note(log, f"rows realigned by {offset:.2f} px")
        trial = _Trial(realigned(pair, offset), span, cost or SHARP, tolerance)
        loss = trial.loss(probes)
    if cost is None and loss >= DOUBT:
        cost = LIGHT if loss < NOISE else HEAVY
        note(log, f"cost {cost.name}: {loss:.0%} of the matches tried found no neighbour to agree with")
        trial, probes = _Trial(trial.pair, span, cost, tolerance), []
    trial.sweep([each for each in rows if each not in probes])
    return trial.out, cost or SHARP


class _Trial:
    """One pair, coded once, and what has been matched of it."""

    def __init__(self, pair: Pair, span: Span, cost: Cost, tolerance: float) -> None:
        self.pair, self.out = pair, blank(pair.left.shape)
        self._codes = cost.codes(pair.left), cost.codes(pair.right)
        self._how = span, cost.prices, tolerance

    def sweep(self, rows: Rows) -> None:
        """Match these strips."""
        sweep(self._codes, self.pair.left, *self._how, rows, self.out)

    def loss(self, rows: Rows) -> float:
        """Match these strips; of the matches in their samples, the share that are specks, which are erased."""
        self.sweep(rows)
        samples = [self.out.disparity[a:b] for a, b in map(_sample, rows)]
        found = sum(np.count_nonzero(each != UNKNOWN) for each in samples)
        return sum(remove_speckles(each) for each in samples) / max(found, 1)


def _spread(rows: Rows) -> Rows:
    """A quarter of the strips, at least two, evenly spread."""
    count = min(len(rows), max(2, len(rows) // 4))
    return [rows[(2 * i + 1) * len(rows) // (2 * count)] for i in range(count)]


def _sample(rows: tuple[int, int]) -> tuple[int, int]:
    """The rows of a strip that are looked at."""
    return rows[0], min(rows[0] + SAMPLE_ROWS, rows[1])


def _offset(trial: _Trial, rows: Rows, loss: float) -> float:
    pair, rows = trial.pair, [_sample(each) for each in rows]
    if loss < NOISE:
        return row_offset(pair, trial.out.disparity, rows)
    found = find_range(pair)  # the matches themselves are suspect: a map of a small copy is rougher but sound
    if found is None:
        return 0.0
    rough = np.repeat(np.repeat(found.rough, found.factor, 0), found.factor, 1)[: pair.left.shape[0], : pair.width]
    rough = np.where(rough == UNKNOWN, UNKNOWN, np.clip(rough.astype(np.int32) * found.factor, -32767, 32767))
    return row_offset(pair, rough.astype(np.int16), rows, reach=4, slack=2)
