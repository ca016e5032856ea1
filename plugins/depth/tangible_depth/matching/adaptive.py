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

from tangible_core.plugins.notes import note

from ..dense.span import UNKNOWN, Span
from ..dense.speckles import remove_speckles
from ..search.bands import match_bands
from ..search.pairs import Pair
from ..search.row_offset import CELL_PX, LEAST_ROW_OFFSET_PX, realigned, row_offset
from ..sgm.census import BITS
from ..sgm.costs import HEAVY, LIGHT, SHARP, Cost
from ..sgm.strips import Swept, blank, sweep

log = logging.getLogger(__name__)
DOUBT, LEAST_DIFFERING, NOISE = 0.06, 0.28, 0.20
"""Loss, or share of differing bits, from which the light cost is taken; loss from which the heavy one is."""
MOST_ROW_OFFSET_PX = 1.0
"""Offsets of rows up to here are found and put right on the way."""
PROBE_ROWS = 64
"""Rows of a strip that are tried before the rest."""
Rows = Sequence[tuple[int, int]]


def match(
    pair: Pair, span: Span, cost: Cost | None, check_tolerance: float, realign_rows: bool, rows: Rows
) -> tuple[Swept, Cost]:
    """The strips `rows` matched, with the given cost or, if None, with the one that the pair calls for."""
    trial = _Trial(pair, span, cost or SHARP, check_tolerance)
    if cost and not realign_rows:
        trial.sweep(rows)
        return trial.out, cost
    probes, rest = _probes(rows)
    health = trial.health(probes)
    row_offset_px = _row_offset(trial, probes, span, health) if realign_rows else 0.0
    if abs(row_offset_px) > LEAST_ROW_OFFSET_PX:
        note(log, f"rows realigned by {row_offset_px:.2f} px")
        trial = _Trial(realigned(pair, row_offset_px), span, cost or SHARP, check_tolerance)
        health = trial.health(probes)
    if cost is None and (cost := _called_for(health)) is not SHARP:
        note(
            log,
            f"cost {cost.name}: {health.loss:.0%} of the matches stand alone, {health.differing:.0%} of bits differ",
        )
        trial, rest = _Trial(trial.pair, span, cost, check_tolerance), rows
    trial.sweep(rest)
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

    def __init__(self, pair: Pair, span: Span, cost: Cost, check_tolerance: float) -> None:
        self.pair, self.out = pair, blank(pair.left.shape)
        self._codes = cost.codes(pair.left), cost.codes(pair.right)
        self._how = span, cost.prices, check_tolerance

    def sweep(self, rows: Rows) -> None:
        """Match these strips."""
        sweep(self._codes, self.pair.left, *self._how, rows, self.out)

    def health(self, rows: Rows) -> _Health:
        """Match these rows and look at what was found; specks are erased."""
        self.sweep(rows)
        parts = [Swept(*(each[a:b] for each in self.out)) for a, b in rows]
        found = max(1, sum(np.count_nonzero(each.disparity != UNKNOWN) for each in parts))
        specks = sum(remove_speckles(each.disparity) for each in parts)
        bits = sum(int(np.sum(each.sums * (each.disparity != UNKNOWN), dtype=np.int64)) for each in parts)
        return _Health(specks / found, bits / (4 * BITS * max(1, found - specks)))


def _probes(rows: Rows) -> tuple[Rows, Rows]:
    """The first PROBE_ROWS of a quarter of the strips, at least two, evenly spread; and all other rows."""
    count = min(len(rows), max(2, len(rows) // 4))
    chosen = {rows[(2 * i + 1) * len(rows) // (2 * count)] for i in range(count)}
    probes = [(a, min(a + PROBE_ROWS, b)) for a, b in rows if (a, b) in chosen]
    rest = [(min(a + PROBE_ROWS, b) if (a, b) in chosen else a, b) for a, b in rows]
    return probes, [(a, b) for a, b in rest if a < b]


def _row_offset(trial: _Trial, probes: Rows, span: Span, health: _Health) -> float:
    if health.loss >= NOISE:  # the matches themselves are suspect: bands average the noise away
        bands = match_bands(trial.pair, span)
        return row_offset(trial.pair, bands.rows, bands.disparity, bands.factor)
    rows = np.array([y for a, b in probes for y in range(a + CELL_PX // 2, b, CELL_PX)], np.int64)
    return row_offset(trial.pair, rows, trial.out.disparity[rows])
