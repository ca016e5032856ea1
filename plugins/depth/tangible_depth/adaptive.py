"""Choosing what to compare by trying it on a part of the picture.

No noise model is needed. A wrong match that passes the left-right check is seldom confirmed by its neighbours, so the
share of checked pixels that the speckle filter erases (the loss) tells how far a cost can be trusted, whatever the
cause: noise, compression, or rows that do not correspond. The strips already swept are kept when all is well, so that a
clean pair pays next to nothing.
"""

import logging
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from .census import BITS
from .costs import HEAVY, LIGHT, SHARP, Cost
from .notes import note
from .pairs import Pair
from .row_offset import realigned, row_offset
from .search_range import find_range
from .span import UNKNOWN, Span
from .speckles import remove_speckles
from .strips import Swept, blank, sweep

log = logging.getLogger(__name__)
DOUBT, LEAST_DIFFERING, NOISE = 0.06, 0.28, 0.20
"""Loss, or share of differing bits, from which the light cost is taken; loss from which the heavy one is."""
LEAST_OFFSET_PX = 0.3
"""Smaller offsets of rows are left alone."""
SAMPLE_ROWS = 48
"""Rows of a strip that the loss and the offset are measured on."""
Rows = Sequence[tuple[int, int]]


def match(pair: Pair, span: Span, cost: Cost | None, tolerance: float, realign: bool, rows: Rows) -> tuple[Swept, Cost]:
    """The strips `rows` matched, with the given cost or, if None, with the one that the pair calls for."""
    trial = _Trial(pair, span, cost or SHARP, tolerance)
    if cost and not realign:
        trial.sweep(rows)
        return trial.out, cost
    probes = _spread(rows)
    health = trial.health(probes)
    offset = _offset(trial, probes, health) if realign else 0.0
    if abs(offset) > LEAST_OFFSET_PX:
        note(log, f"rows realigned by {offset:.2f} px")
        trial = _Trial(realigned(pair, offset), span, cost or SHARP, tolerance)
        health = trial.health(probes)
    if cost is None and (cost := _called_for(health)) is not SHARP:
        note(
            log,
            f"cost {cost.name}: {health.loss:.0%} of the matches stand alone, {health.differing:.0%} of bits differ",
        )
        trial, probes = _Trial(trial.pair, span, cost, tolerance), []
    trial.sweep([each for each in rows if each not in probes])
    return trial.out, cost


class _Health(NamedTuple):
    """How the matches of a trial fare."""

    loss: float
    """Share of them that no neighbour confirms."""
    differing: float
    """Mean share of bits in which both views differ where they match."""


def _called_for(health: _Health) -> Cost:
    if health.loss >= NOISE:
        return HEAVY
    return LIGHT if health.loss >= DOUBT or health.differing >= LEAST_DIFFERING else SHARP


class _Trial:
    """One pair, coded once, and what has been matched of it."""

    def __init__(self, pair: Pair, span: Span, cost: Cost, tolerance: float) -> None:
        self.pair, self.out = pair, blank(pair.left.shape)
        self._codes = cost.codes(pair.left), cost.codes(pair.right)
        self._how = span, cost.prices, tolerance

    def sweep(self, rows: Rows) -> None:
        """Match these strips."""
        sweep(self._codes, self.pair.left, *self._how, rows, self.out)

    def health(self, rows: Rows) -> _Health:
        """Match these strips and look at samples of them; specks in the samples are erased."""
        self.sweep(rows)
        samples = [Swept(*(each[a:b] for each in self.out)) for a, b in map(_sample, rows)]
        found = max(1, sum(np.count_nonzero(each.disparity != UNKNOWN) for each in samples))
        specks = sum(remove_speckles(each.disparity) for each in samples)
        bits = sum(int(np.sum(each.sums * (each.disparity != UNKNOWN), dtype=np.int64)) for each in samples)
        return _Health(specks / found, bits / (4 * BITS * max(1, found - specks)))


def _spread(rows: Rows) -> Rows:
    """A quarter of the strips, at least two, evenly spread."""
    count = min(len(rows), max(2, len(rows) // 4))
    return [rows[(2 * i + 1) * len(rows) // (2 * count)] for i in range(count)]


def _sample(rows: tuple[int, int]) -> tuple[int, int]:
    """The rows of a strip that are looked at."""
    return rows[0], min(rows[0] + SAMPLE_ROWS, rows[1])


def _offset(trial: _Trial, rows: Rows, health: _Health) -> float:
    pair, rows = trial.pair, [_sample(each) for each in rows]
    if health.loss < NOISE:
        return row_offset(pair, trial.out.disparity, rows)
    found = find_range(pair)  # the matches themselves are suspect: a map of a small copy is rougher but sound
    if found is None:
        return 0.0
    rough = np.repeat(np.repeat(found.rough, found.factor, 0), found.factor, 1)[: pair.left.shape[0], : pair.width]
    rough = np.where(rough == UNKNOWN, UNKNOWN, np.clip(rough.astype(np.int32) * found.factor, -32767, 32767))
    return row_offset(pair, rough.astype(np.int16), rows, reach=4, slack=2)
