"""Measures of answers without a function of a level: shares of the trials with d', choices of two, and numbers."""

from collections.abc import Callable
from dataclasses import replace
from math import nan

import numpy as np
from jaxtyping import Float64

from tangible_core.errors import ResultsError, quoted

from ..design import Comparison
from ..statistics import intervals
from ..statistics.bradley_terry import fit_scale
from ..statistics.intervals import Estimate
from ..statistics.sensitivity import two_afc
from ..trials import Answer
from .rows import (
    ALL,
    ByParticipant,
    Result,
    Row,
    What,
    contrasts,
    group_answers,
    label,
    of_each_and_all,
    over_participants,
    proportion_row,
    together,
)

CORRECT = "proportion correct"
CHOSEN = "proportion chosen"
DPRIME = "d'"


def analyse_right_answers(
    comparison: Comparison,
    answers: ByParticipant,
    chance: float,
    inverse: Callable[[float], float] | None = None,
    *,
    with_contrasts: bool = False,
) -> Result:
    """Analyse how often an answer was right. chance: by guessing. inverse: d' from such a share."""

    def make_rows(name: str, some: list[Answer]) -> list[Row]:
        return share_rows(CORRECT, name, some, lambda each: each.correct, chance, one_sided=True)

    rows, all_together = of_each_and_all(make_rows, answers)
    between = contrasts(CORRECT, rows, all_together) if with_contrasts else []
    dprimes = [] if inverse is None else [with_dprime(row, inverse) for row in rows]
    return Result(comparison.name, comparison.question, list(answers), [*rows, *dprimes, *between], CORRECT)


def share_rows(
    measure: str,
    name: str,
    answers: list[Answer],
    hit: Callable[[Answer], int | None],
    chance: float,
    *,
    one_sided: bool = False,
) -> list[Row]:
    """Return the share of hits among a participant's answers, for each condition, and level if one varies."""
    cells = group_answers(answers, lambda answer: What(measure, label(answer), answer.other or ""))
    return [
        proportion_row(what, name, [hit(answer) or 0 for answer in cell], chance, one_sided)
        for what, cell in cells.items()
    ]


def with_dprime(row: Row, inverse: Callable[[float], float]) -> Row:
    """Return the row of d' that belongs to a row of shares. inverse: d' from a share."""
    edge = 0.5 / max(row.trials, 1)  # all right, or all wrong: half an answer less (Macmillan & Kaplan 1985)
    dprime = row.estimate.map(inverse)
    value = inverse(min(max(row.estimate.value, edge), 1 - edge)) if row.estimate.value == row.estimate.value else nan
    return replace(row, what=row.what._replace(measure=DPRIME), estimate=Estimate(value, *dprime[1:]), chance=0.0)


SPREAD = "standard deviation"


def analyse_quantities(
    comparison: Comparison,
    answers: ByParticipant,
    measure: str,
    *,
    origin: float = 0.0,
    chance: float = nan,
    unit: str = "",
    about: Callable[[Answer], str] = label,
) -> Result:
    """Analyse numbers, less their origin, by their mean, and how conditions differ."""
    rows: list[Row] = []
    for name, some in answers.items():
        for condition, cell in group_answers(some, about).items():
            values = [_number(answer) - origin for answer in cell]
            p = nan if chance != chance else intervals.p_of_mean(values, chance)
            rows.append(Row(What(measure, condition), name, intervals.mean(values), unit, len(cell), None, chance, p))
            if len(values) > 1:
                spread = Estimate(float(np.std(values, ddof=1)))
                rows.append(Row(What(SPREAD, condition), name, spread, unit, len(cell)))
    if len(answers) > 1:
        rows += over_participants(rows)
    rows += contrasts(measure, rows)
    return Result(comparison.name, comparison.question, list(answers), rows, measure)


def _number(answer: Answer) -> float:
    try:
        return float(answer.response)
    except ValueError as error:
        raise ResultsError(
            f"trial {answer.trial} of {answer.comparison}: {quoted(answer.response)} is not a number; correct it"
        ) from error


SCALE = "scale value"
DIFFERENCE = f"difference of {SCALE}"


def analyse_pairs(comparison: Comparison, answers: ByParticipant) -> Result:
    """Analyse how often each condition was chosen over each other one; three or more are placed on a scale."""

    def make_rows(name: str, some: list[Answer]) -> list[Row]:
        return share_rows(CHOSEN, name, some, lambda each: each.chosen, 0.5)

    rows, _ = of_each_and_all(make_rows, answers)
    dprimes = [with_dprime(row, two_afc) for row in rows]
    notes = note_on_order(together(answers))
    names = [condition for condition in comparison.conditions if any(condition in (row.what[1:]) for row in rows)]
    if len(names) < 3:
        return Result(comparison.name, comparison.question, list(answers), [*rows, *dprimes], CHOSEN, notes=notes)
    scale = fit_scale([count_wins(list(some), names) for some in answers.values()])
    whom, trials = ALL if len(answers) > 1 else next(iter(answers)), sum(map(len, answers.values()))
    values = [Row(What(SCALE, name), whom, scale.estimate(index), "", trials) for index, name in enumerate(names)]
    between = [
        Row(What(DIFFERENCE, one, other), whom, scale.difference(first, second), "", trials, None, 0.0)
        for second, other in enumerate(names)
        for first, one in enumerate(names)
        if first > second
    ]
    if scale.was_completed:
        notes = [*notes, "One condition was always chosen over others, so that half a choice was added to each pair."]
    everything = [*rows, *dprimes, *values, *between]
    return Result(comparison.name, comparison.question, list(answers), everything, SCALE, notes=notes)


def count_wins(answers: list[Answer], names: list[str]) -> Float64[np.ndarray, "n n"]:
    """Return how often each condition (row) was chosen over each other one (column)."""
    wins = np.zeros((len(names), len(names)))
    for answer in answers:
        if answer.other is not None and answer.chosen is not None:
            pair = names.index(answer.condition), names.index(answer.other)
            wins[pair if answer.chosen else pair[::-1]] += 1
    return wins


def note_on_order(answers: list[Answer]) -> list[str]:
    """Return a note if the first of two intervals was chosen more or less often than the second."""
    first = proportion_row(What("first interval", ""), ALL, [int(answer.response == "1") for answer in answers], 0.5)
    if not answers or first.estimate.holds(0.5):
        return []
    share = first.estimate.value
    return [
        f"The first interval was chosen in {100 * share:.0f} % of the trials, whatever it was. Each condition comes "
        "first equally often, so that this adds noise and no bias."
    ]
