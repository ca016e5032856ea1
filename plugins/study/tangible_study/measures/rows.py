"""The rows of a result: a measure, of whom, its estimate, what it would be by chance; and their figures in words."""

from collections.abc import Callable, Hashable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import combinations
from math import inf, isfinite, isinf, isnan, nan
from typing import Any, NamedTuple, TypeVar

from ..statistics import intervals
from ..statistics.intervals import Estimate
from ..statistics.psychometric import Blocks, Curve
from ..trials import Answer

ALL = "all"  # participant of a row about all participants
Key = TypeVar("Key", bound=Hashable)
ByParticipant = Mapping[str, Sequence[Answer]]  # answers of one comparison by participant


class What(NamedTuple):
    """The subject of a row."""

    measure: str
    condition: str
    other: str = ""  # condition with which it is compared


@dataclass(frozen=True)
class Row:
    """A figure of one participant, or of all."""

    what: What
    participant: str
    estimate: Estimate
    unit: str = ""
    trials: int = 0
    count: int | None = None  # number of trials that were right, or with the condition chosen
    chance: float = nan  # value by chance alone; NaN if there is none
    p: float = nan  # probability of a value this far from chance by chance alone


@dataclass(frozen=True)
class Result:
    """All that is known about one comparison."""

    comparison: str
    question: str
    participants: Sequence[str]
    rows: Sequence[Row]
    main: str  # measure that the question is about
    # Fitted functions by participant and condition, joined by a slash.
    curves: Mapping[str, Curve] = field(default_factory=dict[str, Curve])
    blocks: Mapping[str, Blocks] = field(default_factory=dict[str, Blocks])
    notes: Sequence[str] = ()  # remarks for a reader, as sentences

    def of_all(self, measure: str) -> list[Row]:
        """Return the rows of a measure about all participants; those of the only participant if there is one."""
        whom = ALL if len(self.participants) > 1 else self.participants[0]
        return [row for row in self.rows if row.what.measure == measure and row.participant == whom]


def proportion_row(what: What, participant: str, hits: Sequence[int], chance: float, one_sided: bool = False) -> Row:
    """Return the share of hits (1 or 0 each) with its exact interval and test against chance."""
    count, trials = sum(hits), len(hits)
    p = intervals.p_of_count(count, trials, chance, one_sided)
    return Row(what, participant, intervals.proportion(count, trials), "", trials, count, chance, p)


def over_participants(
    rows: Iterable[Row], all_together: Mapping[What, Row] | None = None, bounds: tuple[float, float] = (0.0, 1.0)
) -> list[Row]:
    """Return a row about all participants for each thing: the mean over them, within the bounds."""
    groups: dict[What, list[Row]] = {}
    for row in rows:
        groups.setdefault(row.what, []).append(row)
    return [_mean_row(what, group, (all_together or {}).get(what), bounds) for what, group in groups.items()]


def _mean_row(what: What, group: Sequence[Row], all_together: Row | None, bounds: tuple[float, float]) -> Row:
    estimates = [row.estimate for row in group if row.estimate.value == row.estimate.value]
    estimate, chance = intervals.mean_of_estimates(estimates, closed_ends=all_together is not None), group[0].chance
    p = intervals.p_of_mean([single.value for single in estimates], chance) if isfinite(chance) else nan
    trials = sum(row.trials for row in group)
    row = Row(what, ALL, estimate, group[0].unit, trials, None, chance, p)
    if all_together is None:
        return row
    # The wider interval and the greater p count: participants who differ make a result uncertain, as do few trials.
    wider = intervals.wider(estimate, all_together.estimate)
    within_bounds = Estimate(wider.value, max(wider.low, bounds[0]), min(wider.high, bounds[1]))
    chances = [p_value for p_value in (p, all_together.p) if p_value == p_value]
    return replace(row, estimate=within_bounds, count=all_together.count, p=max(chances, default=nan))


def of_each_and_all(
    make_rows: Callable[[str, list[Answer]], list[Row]],
    answers: ByParticipant,
    bounds: tuple[float, float] = (0.0, 1.0),
) -> tuple[list[Row], dict[What, Row]]:
    """Return the rows of each participant and of all, and those of all trials together by quantity."""
    single = [row for name, some in answers.items() for row in make_rows(name, list(some))]
    all_together = {row.what: row for row in make_rows("pooled", together(answers))}
    return [*single, *(over_participants(single, all_together, bounds) if len(answers) > 1 else ())], all_together


def contrast(
    one: Row, other: Row, groups: tuple[Sequence[Row], Sequence[Row]], all_together: Estimate | None = None
) -> Row:
    """Return how much larger a measure is in one condition than in another, by the participants who have both."""
    what = What(f"difference of {one.what.measure}", one.what.condition, other.what.condition)
    row = Row(what, one.participant, Estimate(nan), one.unit, one.trials + other.trials, None, 0.0)
    seconds = {row.participant: row.estimate for row in groups[1]}
    pairs = [(row.estimate, seconds[row.participant]) for row in groups[0] if row.participant in seconds]
    differences = [intervals.difference(*pair) for pair in pairs if not any(isnan(side.value) for side in pair)]
    if len(differences) < 2:
        return replace(row, estimate=intervals.difference(one.estimate, other.estimate))
    estimate = intervals.mean_of_estimates(differences, closed_ends=all_together is not None)
    p = intervals.p_of_mean([apart.value for apart in differences], 0.0)
    return replace(row, estimate=estimate if all_together is None else intervals.wider(estimate, all_together), p=p)


def contrasts(measure: str, rows: Sequence[Row], all_together: Mapping[What, Row] | None = None) -> list[Row]:
    """Return the differences of a measure between all pairs of conditions, later ones less earlier ones."""
    same_measure = [row for row in rows if row.what.measure == measure]
    names = list(dict.fromkeys(row.what for row in same_measure))
    differences: list[Row] = []
    for other, one in combinations(names, 2):
        groups = tuple(
            [row for row in same_measure if row.what == what and row.participant != ALL] for what in (one, other)
        )
        totals = [next((row for row in reversed(same_measure) if row.what == what), None) for what in (one, other)]
        if totals[0] is not None and totals[1] is not None:
            both = (
                None
                if all_together is None
                else intervals.difference(all_together[one].estimate, all_together[other].estimate)
            )
            differences.append(contrast(totals[0], totals[1], (groups[0], groups[1]), both))
    return differences


def as_record(row: Row) -> dict[str, Any]:
    """Return a row as the table of results and `--json` have it."""
    return {
        "measure": row.what.measure,
        "condition": row.what.condition,
        "other": row.what.other or None,
        "participant": row.participant,
        "value": row.estimate.value,
        "low": row.estimate.low,
        "high": row.estimate.high,
        "unit": row.unit or None,
        "trials": row.trials,
        "count": row.count,
        "chance": row.chance,
        "p": row.p,
    }


def group_answers(answers: Sequence[Answer], key: Callable[[Answer], Key]) -> dict[Key, list[Answer]]:
    """Return answers by a key, in the order of the first of each."""
    groups: dict[Key, list[Answer]] = {}
    for answer in answers:
        groups.setdefault(key(answer), []).append(answer)
    return groups


def label(answer: Answer) -> str:
    """Return the condition of an answer, with its level if one varies."""
    return answer.condition if answer.level is None else f"{answer.condition} at {answer.level:g}"


def together(answers: ByParticipant) -> list[Answer]:
    """Return the answers of all participants."""
    return [answer for own in answers.values() for answer in own]


def people(count: int) -> str:
    """Return a number of participants in words."""
    return "1 participant" if count == 1 else f"{count} participants"


def is_sure(row: Row) -> bool:
    """Return True if chance alone is not a likely reason: it is outside the interval, and p is below 0.05."""
    return row.estimate.has_interval and not row.estimate.holds(row.chance) and not row.p >= 0.05


def odds(row: Row) -> str:
    """Return how rarely chance alone gives a result as clear as this; "" if that is not rare."""
    if not row.p < 0.05:
        return ""
    studies = "fewer than 1 of 10,000" if row.p < 1e-4 else f"about 1 of {float(f'{1 / row.p:.1g}'):,.0f}"
    return f"If there were no difference, a result as clear as this would come about in {studies} studies."


def share(row: Row) -> str:
    """Return a share of the trials with its interval."""
    value, low, high = (100 * figure for figure in row.estimate)
    return f"{value:.0f} % of {row.trials} trials (95 % interval {low:.0f} to {high:.0f} %)"


def discrimination_in_words(row: Row, claim: str) -> str:
    """Return whether two conditions can be told apart. answered: who answered what rightly."""
    what, one, other = share(row), row.what.condition, row.what.other
    guess = f"guessing gives {100 * row.chance:.0f} %."
    if is_sure(row):
        return f"{one} and {other} can be told apart: {claim} in {what}; {guess}"
    return f"It is open whether {one} and {other} can be told apart: {claim} in {what}, and {guess}"


def interval(low: float, high: float) -> str:
    """Return the interval of an estimate."""
    if isnan(low):
        return "no interval from one value"
    if isinf(high):
        return f"95 % interval from {low:.3g} upwards" if isfinite(low) else "95 % interval without bounds"
    return f"95 % interval {low:.3g} to {high:.3g}" if isfinite(low) else f"95 % interval up to {high:.3g}"


def bound_in_words(row: Row) -> str:
    """Return an estimate that is the end of its interval."""
    _, low, high = row.estimate
    return f"below {high:.3g} {row.unit}" if high < inf else f"above {low:.3g} {row.unit}"
