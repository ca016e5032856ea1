"""Choice of the matching cost by a trial on a part of the picture."""

import logging
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from jaxtyping import UInt8

from tangible_core.plugins import note

from ..dense.filling.gaps import Effort
from ..dense.span import UNKNOWN, Span
from ..dense.speckles import ISLAND_PX, remove_speckles
from ..row_alignment.common_rows import shift_rows
from ..row_alignment.row_offset import CELL_PX, MIN_ROW_OFFSET_PX, row_offset
from ..search.bands import match_bands
from ..search.pairs import Pair
from ..sgm.costs import HEAVY, LEVELS, LIGHT, SHARP, Cost
from ..sgm.strips import WARM_ROWS, StripMatches, sweep, unknown_matches

log: logging.Logger = logging.getLogger(__name__)
NOISE = 0.20
# Loss of matches by order and levels from which the order alone loses more than NOISE too: it is not tried.
FAR_TOO_NOISY = 0.40
# Loss, and share of differing bits and levels, from which levels mislead: other exposure, or noise.
LEVELS_LOSS, LEVELS_DIFFERING = 0.06, 0.265
LEVELS_APART = 0.6
"""Share of matches whose levels differ by the most that counts from which the views were exposed differently."""
EVERY_ROW = 16
MAX_ROW_OFFSET_PX = 1.0  # largest row offset, in pixels, that the trial measures and corrects
PROBE_ROWS = 64  # rows of a strip that a trial matches
Rows = Sequence[tuple[int, int]]  # first and last + 1 row of strips


class _Spending(NamedTuple):
    """The thresholds of an effort for noise, and the rows that it spends on seams."""

    speckle_threshold: float  # loss from which `sharp` gives way to a cost for noise
    differing_threshold: float
    warm_rows: int  # rows by which the paths of a strip begin early: the more, the less a seam is seen


SPENDING: dict[Effort, _Spending] = {"balanced": _Spending(0.06, 0.28, WARM_ROWS), "best": _Spending(0.11, 0.315, 24)}


class Fixed(NamedTuple):
    """What the options fix; a trial finds the rest."""

    cost: Cost | None  # cost of the matching; None for the one that a trial chooses
    check_tolerance: float
    realign_rows: bool
    effort: Effort


class MatchedView(NamedTuple):
    """A view as it was matched, and its matches."""

    matches: StripMatches
    grey: UInt8[np.ndarray, "h w"]


class Matched(NamedTuple):
    """The matches of a pair."""

    left: MatchedView
    # With `effort: best`, the right view, mirrored, its rows where they were: the left one of the exchanged pair.
    mirrored_right: MatchedView | None
    cost: Cost


def match(pair: Pair, span: Span, rows: Rows, options: Fixed) -> Matched:
    """Match the strips `rows`, and with `effort: best` those of the exchanged pair too."""
    trial = _match(pair, span, rows, options)
    if options.effort != "best":
        return Matched(trial.left, None, trial.cost)
    right_trial = trial.with_pair(trial.pair.exchange())
    right_trial.sweep(rows)
    return Matched(trial.left, right_trial.left, trial.cost)


def _match(pair: Pair, span: Span, rows: Rows, options: Fixed) -> "_Trial":
    cost, check_tolerance, realign_rows, effort = options
    trial = _Trial(pair, span, cost or LEVELS, check_tolerance, effort)
    if cost and not realign_rows:
        trial.sweep(rows)
        return trial
    probes, rest = _probes(rows)
    health = trial.health(probes)
    row_offset_px = _row_offset(trial, probes, span, health) if realign_rows else 0.0
    if abs(row_offset_px) > MIN_ROW_OFFSET_PX:
        note(log, f"rows realigned by {row_offset_px:.2f} px")
        trial = trial.with_pair(shift_rows(pair, row_offset_px))
        health = trial.health(probes)
    if cost:
        trial.sweep(rest)
        return trial
    choice = trial.cost
    if choice.most_level and (why := _why_levels_mislead(health, trial.levels_apart(probes))):
        note(log, f"skipped: comparing grey levels, as {why}")
        choice = SHARP
        if health.loss < FAR_TOO_NOISY:
            trial = trial.with_cost(SHARP)
            health = trial.health(probes)
    if choice is SHARP and (choice := _cost_for_noise(health, effort)) is not SHARP:
        bits = f", {health.differing:.0%} of census bits differ" if trial.cost is SHARP else ""
        note(log, f"cost {choice.name}: {health.loss:.0%} of the matches are speckles{bits}")
    if choice is not trial.cost:
        trial, rest = trial.with_cost(choice), rows
    trial.sweep(rest)
    return trial


class _Health(NamedTuple):
    """The quality of a trial's matches."""

    loss: float
    differing: float


def _cost_for_noise(health: _Health, effort: Effort) -> Cost:
    if health.loss >= NOISE:
        return HEAVY
    spending = SPENDING[effort]
    doubtful = health.loss >= spending.speckle_threshold or health.differing >= spending.differing_threshold
    return LIGHT if doubtful else SHARP


def _why_levels_mislead(health: _Health, apart: float) -> str:
    """Return the reason against comparing the grey levels of both views; empty if there is none."""
    if apart >= LEVELS_APART:
        return f"{apart:.0%} of them are far apart where the views match: the exposures differ"
    if health.loss >= LEVELS_LOSS or health.differing >= LEVELS_DIFFERING:
        return f"{health.loss:.0%} of the matches are speckles, and {health.differing:.0%} of bits and levels differ"
    return ""


class _Trial:
    """A pair with its codes of one cost, and the matches so far."""

    def __init__(self, pair: Pair, span: Span, cost: Cost, check_tolerance: float, effort: Effort) -> None:
        self.pair, self.cost, self.out = pair, cost, unknown_matches(pair.left.shape)
        self._span, self._check_tolerance = span, check_tolerance
        self._effort: Effort = effort
        self._codes = cost.codes(pair.left), cost.codes(pair.right)

    @property
    def left(self) -> MatchedView:
        """The left view with the matches so far."""
        return MatchedView(self.out, self.pair.left)

    def with_pair(self, pair: Pair) -> "_Trial":
        """Return a new trial of another pair at this cost."""
        return _Trial(pair, self._span, self.cost, self._check_tolerance, self._effort)

    def with_cost(self, cost: Cost) -> "_Trial":
        """Return a new trial of this pair at another cost."""
        return _Trial(self.pair, self._span, cost, self._check_tolerance, self._effort)

    def sweep(self, rows: Rows) -> None:
        """Match these strips."""
        how = self._span, self.cost.penalties, self._check_tolerance
        sweep(self._codes, self.pair.left, *how, rows, self.out, SPENDING[self._effort].warm_rows, self.cost.most_level)

    def health(self, rows: Rows) -> _Health:
        """Match these rows and count the speckles; none is removed, as it may extend beyond the rows."""
        # No noise model is needed: a wrong match that passes the left-right check is seldom confirmed by its
        # neighbours, so the share of speckles measures how far a cost can be trusted, be it for noise, compression or
        # rows that differ.
        self.sweep(rows)
        parts = [StripMatches(self.out.disparity[a:b].copy(), self.out.sums[a:b]) for a, b in rows]
        matches = max(1, sum(np.count_nonzero(part.disparity != UNKNOWN) for part in parts))
        specks = sum(remove_speckles(part.disparity, ISLAND_PX) for part in parts)
        bits = sum(int(np.sum(part.sums * (part.disparity != UNKNOWN), dtype=np.int64)) for part in parts)
        return _Health(specks / matches, bits / (4 * self.cost.bits * max(1, matches - specks)))

    def levels_apart(self, rows: Rows) -> float:
        """Return the share of matches in these rows whose levels differ by the most that counts."""
        y = np.array([y for a, b in rows for y in range(a, b, EVERY_ROW)], np.int64)
        disparity = self.out.disparity[y]
        i, x = np.nonzero(disparity != UNKNOWN)
        there = np.clip(x - ((disparity[i, x] + 8) >> 4), 0, self.pair.width - 1)
        levels = (self.pair.left[y[i], x] >> 1).astype(np.int16), self.pair.right[y[i], there] >> 1
        apart = np.count_nonzero(np.abs(np.subtract(*levels)) >= self.cost.most_level)
        return apart / max(1, len(x))


def _probes(rows: Rows) -> tuple[Rows, Rows]:
    """Return the first PROBE_ROWS of a quarter of the strips, at least two, evenly spread; and all other rows."""
    count = min(len(rows), max(2, len(rows) // 4))
    probe_strips = {rows[(2 * i + 1) * len(rows) // (2 * count)] for i in range(count)}
    probes = [(a, min(a + PROBE_ROWS, b)) for a, b in rows if (a, b) in probe_strips]
    rest = [(min(a + PROBE_ROWS, b) if (a, b) in probe_strips else a, b) for a, b in rows]
    return probes, [(a, b) for a, b in rest if a < b]


def _row_offset(trial: _Trial, probes: Rows, span: Span, health: _Health) -> float:
    if health.loss >= NOISE:  # too many wrong matches: bands average the noise away
        bands = match_bands(trial.pair, span)
        return row_offset(trial.pair, bands.rows, bands.disparity, bands.factor)
    rows = np.array([y for a, b in probes for y in range(a + CELL_PX // 2, b, CELL_PX)], np.int64)
    return row_offset(trial.pair, rows, trial.out.disparity[rows])
