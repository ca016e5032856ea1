"""Choosing what to compare by trying it on a part of the picture.

No noise model is needed. A wrong match that passes the left-right check is seldom confirmed by its neighbours, so the
share of checked pixels that the speckle filter erases (the loss) tells how far a cost can be trusted, whatever the
cause: noise, compression, or rows that do not correspond. What the matches cost tells whether the grey levels of both
views may be compared themselves, besides their order. The strips already swept are kept when all is well, so that a
clean pair pays next to nothing.
"""

import logging
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from tangible_core.plugins.notes import note

from ..dense.filling.gaps import Effort
from ..dense.span import UNKNOWN, Span
from ..dense.speckles import ISLAND_PX, remove_speckles
from ..row_alignment.row_offset import CELL_PX, LEAST_ROW_OFFSET_PX, realigned, row_offset
from ..search.bands import match_bands
from ..search.pairs import Pair
from ..sgm.costs import HEAVY, LEVELS, LIGHT, SHARP, Cost
from ..sgm.strips import WARM_ROWS, StripMatches, blank, sweep

log = logging.getLogger(__name__)
NOISE = 0.20
"""Loss from which the heavy cost is taken."""
LEVELS_LOSS, LEVELS_DIFFERING = 0.06, 0.265
"""Loss, and share of its bits and levels by which matches differ, from which levels mislead: exposures, or noise."""
LEVELS_APART, EVERY_ROW = 0.6, 4
"""Share of matches whose levels differ by all that counts from which the views were exposed differently, and in which
rows of the trial this is looked for."""
MOST_ROW_OFFSET_PX = 1.0
"""Offsets of rows up to here are found and put right on the way."""
PROBE_ROWS = 64
"""Rows of a strip that are tried before the rest."""
Rows = Sequence[tuple[int, int]]


class _Spending(NamedTuple):
    """The cost that an effort tries first, what it takes for noise, and the rows that it spends on seams."""

    first: Cost
    """The cost that is tried first."""
    speckle_threshold: float
    """Loss from which `sharp` gives way to a cost for noise."""
    differing_threshold: float
    """Share of differing bits from which `sharp` gives way to a cost for noise."""
    warm_rows: int
    """Rows by which the paths of a strip begin early: the more, the less a seam is seen."""


SPENDING: dict[Effort, _Spending] = {
    "balanced": _Spending(SHARP, 0.06, 0.28, WARM_ROWS),
    "best": _Spending(LEVELS, 0.11, 0.315, 48),
}


def match(
    pair: Pair,
    span: Span,
    cost: Cost | None,
    check_tolerance: float,
    realign_rows: bool,
    rows: Rows,
    effort: Effort,
) -> tuple[StripMatches, Cost]:
    """The strips `rows` matched, with the given cost or, if None, with the one that the pair calls for."""
    trial = _Trial(pair, span, cost or SPENDING[effort].first, check_tolerance, effort)
    if cost and not realign_rows:
        trial.sweep(rows)
        return trial.out, cost
    probes, rest = _probes(rows)
    health = trial.health(probes)
    row_offset_px = _row_offset(trial, probes, span, health) if realign_rows else 0.0
    if abs(row_offset_px) > LEAST_ROW_OFFSET_PX:
        note(log, f"rows realigned by {row_offset_px:.2f} px")
        trial = trial.of(realigned(pair, row_offset_px))
        health = trial.health(probes)
    if cost:
        trial.sweep(rest)
        return trial.out, cost
    if trial.cost.most_level and (why := _why_no_levels(health, trial.levels_apart(probes))):
        note(log, f"skipped: comparing grey levels, as {why}")
        trial = trial.at(SHARP)
        health = trial.health(probes)
    if trial.cost is SHARP and (called_for := _called_for(health, effort)) is not SHARP:
        note(
            log,
            f"cost {called_for.name}: {health.loss:.0%} of the matches stand alone, "
            f"{health.differing:.0%} of bits differ",
        )
        trial, rest = trial.at(called_for), rows
    trial.sweep(rest)
    return trial.out, trial.cost


class _Health(NamedTuple):
    """How the matches of a trial fare."""

    loss: float
    """Share of them that no neighbour confirms."""
    differing: float
    """Mean share of bits in which both views differ where they match."""


def _called_for(health: _Health, effort: Effort) -> Cost:
    if health.loss >= NOISE:
        return HEAVY
    spending = SPENDING[effort]
    doubtful = health.loss >= spending.speckle_threshold or health.differing >= spending.differing_threshold
    return LIGHT if doubtful else SHARP


def _why_no_levels(health: _Health, apart: float) -> str:
    """Empty where both views' grey levels may be compared."""
    if apart >= LEVELS_APART:
        return f"{apart:.0%} of them are far apart where the views match: they were exposed differently"
    if health.loss >= LEVELS_LOSS or health.differing >= LEVELS_DIFFERING:
        return f"{health.loss:.0%} of the matches stand alone, and {health.differing:.0%} of bits and levels differ"
    return ""


class _Trial:
    """One pair, coded once, and what has been matched of it."""

    def __init__(self, pair: Pair, span: Span, cost: Cost, check_tolerance: float, effort: Effort) -> None:
        self.pair, self.cost, self.out = pair, cost, blank(pair.left.shape)
        self._span, self._check_tolerance = span, check_tolerance
        self._effort: Effort = effort
        self._codes = cost.codes(pair.left), cost.codes(pair.right)

    def of(self, pair: Pair) -> "_Trial":
        """The same of another pair."""
        return _Trial(pair, self._span, self.cost, self._check_tolerance, self._effort)

    def at(self, cost: Cost) -> "_Trial":
        """The same at another cost."""
        return _Trial(self.pair, self._span, cost, self._check_tolerance, self._effort)

    def sweep(self, rows: Rows) -> None:
        """Match these strips."""
        how = self._span, self.cost.penalties, self._check_tolerance
        sweep(self._codes, self.pair.left, *how, rows, self.out, SPENDING[self._effort].warm_rows, self.cost.most_level)

    def health(self, rows: Rows) -> _Health:
        """Match these rows and look at what was found, specks being errors; none is erased: it may reach beyond."""
        self.sweep(rows)
        parts = [StripMatches(self.out.disparity[a:b].copy(), self.out.sums[a:b]) for a, b in rows]
        found = max(1, sum(np.count_nonzero(each.disparity != UNKNOWN) for each in parts))
        specks = sum(remove_speckles(each.disparity, ISLAND_PX) for each in parts)
        bits = sum(int(np.sum(each.sums * (each.disparity != UNKNOWN), dtype=np.int64)) for each in parts)
        return _Health(specks / found, bits / (4 * self.cost.bits * max(1, found - specks)))

    def levels_apart(self, rows: Rows) -> float:
        """Share of the matches in these rows whose levels differ by all that counts; of a cost that has levels."""
        apart = found = 0
        for y in (y for a, b in rows for y in range(a, b, EVERY_ROW)):
            (x,) = np.nonzero(self.out.disparity[y] != UNKNOWN)
            there = np.clip(x - ((self.out.disparity[y, x] + 8) >> 4), 0, self.pair.width - 1)
            apart_here = np.abs((self.pair.left[y, x] >> 1).astype(np.int16) - (self.pair.right[y, there] >> 1))
            apart += np.count_nonzero(apart_here >= self.cost.most_level)
            found += len(x)
        return apart / max(1, found)


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
