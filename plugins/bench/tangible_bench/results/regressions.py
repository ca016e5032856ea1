"""Regressions: the figures that got worse between two files of results, beyond the noise of their repeats."""

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from tangible_core.errors import ResultsError, shown

from ..measuring.rows import Row
from ..tasks.task import Measure, load_task
from .summary import Cell, cells, median, spread

# The number of standard deviations by which medians may differ and still count as the same.
SPREADS = 3.0
# The shares by which time and memory may differ in any case, even where the repeats have no noise.
TIME_FLOOR, MEMORY_FLOOR = 0.1, 0.05
MEMORY_FLOOR_BYTES = 2**20  # the difference of memory that always counts as the same, bytes


@dataclass(frozen=True)
class Regression:
    """A figure of one cell that got worse."""

    method: str
    scene: str
    perturb: str
    what: str
    before: float
    after: float
    allowed: float  # the largest difference that would have counted as the same
    why: str = ""


@dataclass(frozen=True)
class Verdict:
    """The result of a comparison of two files."""

    compared: int
    """The number of cells that both files hold."""
    missing: tuple[str, ...]
    """Cells that only one file holds, or whose scene has other content now."""
    time: str
    """A few words on how times were compared."""
    worse: tuple[Regression, ...]


def find_regressions(before: Sequence[Row], after: Sequence[Row]) -> Verdict:
    """Compare two sets of rows cell by cell: method (by label), scene, perturbation.

    Raises: ResultsError if the files have no cell in common, or cannot be compared.
    """
    if not before or not after:
        raise ResultsError("a file without rows cannot be compared; measure first")
    kinds = {before[-1].compare, after[-1].compare}
    if len(kinds) > 1:
        raise ResultsError(f"one file compares {before[-1].compare}, the other {after[-1].compare}")
    baseline = _common_baseline(before, after)
    old, new = cells(before, baseline), cells(after, baseline)
    in_common = [key for key in old if key in new and old[key].scene_digest == new[key].scene_digest]
    if not in_common:
        raise ResultsError("the files have no method on a scene in common: labels, scenes or pictures all differ")
    measures = load_task(kinds.pop()).measures
    worse = [
        regression
        for key in in_common
        for regression in _regressions(old[key], new[key], measures, baseline is not None)
    ]
    missing = [" | ".join(key) for key in {**old, **new} if key not in in_common]
    time = f"times as ratios to {baseline}" if baseline else "times in seconds, on the same machine"
    return Verdict(len(in_common), tuple(missing), time, tuple(worse))


def _common_baseline(before: Sequence[Row], after: Sequence[Row]) -> str | None:
    baseline = before[-1].baseline
    if baseline and baseline == after[-1].baseline:
        return baseline
    if before[-1].machine != after[-1].machine:
        one, other = (shown(str(rows[-1].machine.get("processor"))) for rows in (before, after))
        raise ResultsError(
            f"seconds on {one} and on {other} cannot be compared; name the same `baseline:` in both to compare ratios"
        )
    return None


def _regressions(old: Cell, new: Cell, measures: Mapping[str, Measure], by_ratio: bool) -> Iterator[Regression]:
    if new.error and not old.error:
        yield Regression(*new.key, "fails", math.nan, math.nan, 0.0, new.error)
    if old.error or new.error:
        return
    times = (old.ratios, new.ratios) if by_ratio else (old.seconds, new.seconds)
    yield from _noisy(new, "time / baseline" if by_ratio else "time s", *times, TIME_FLOOR, 0.0)
    yield from _noisy(new, "memory bytes", old.memory_bytes, new.memory_bytes, MEMORY_FLOOR, MEMORY_FLOOR_BYTES)
    for name, measure in measures.items():
        if name in old.measures:
            yield from _exact(new, measure, old.measures[name], new.measures.get(name, math.nan))


def _noisy(
    cell: Cell, what: str, old: Sequence[float], new: Sequence[float], share: float, least: float
) -> Iterable[Regression]:
    # s is the root of the sum of both squared standard deviations: medians within 3 s of each other are the same.
    before, after = median(old), median(new)
    tolerance = max(SPREADS * math.hypot(spread(old), spread(new)), share * before, least)
    return [Regression(*cell.key, what, before, after, tolerance)] if after - before > tolerance else []


def _exact(cell: Cell, measure: Measure, before: float, after: float) -> Iterable[Regression]:
    rise = after - before if measure.best == "low" else before - after
    is_gone = math.isnan(after) and not math.isnan(before)
    return (
        [Regression(*cell.key, measure.title, before, after, measure.tolerance)]
        if is_gone or rise > measure.tolerance
        else []
    )
