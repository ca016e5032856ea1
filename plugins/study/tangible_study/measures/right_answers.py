"""Answers that are right or wrong: the odd one of three, the same or different, and names of parts."""

from dataclasses import replace
from math import inf, nan

from ..design.study import Comparison
from ..design.trial import DIFFERENT, SAME
from ..statistics import sensitivity
from ..statistics.intervals import Estimate
from ..trials import Answer
from .rows import (
    ByParticipant,
    Result,
    Row,
    What,
    contrasts,
    grouped,
    label,
    over_participants,
    proportion_row,
    together,
)

CORRECT = "proportion correct"
DPRIME = "d'"


def analyse_choices(comparison: Comparison, answers: ByParticipant) -> Result:
    """Analyse how often the odd one of three, or a part, was named rightly."""
    return _analyse(comparison, answers, 1 / (len(comparison.names) if comparison.question == "name" else 3))


def analyse_differences(comparison: Comparison, answers: ByParticipant) -> Result:
    """Analyse how rightly two intervals were called the same or different, for each pair of conditions."""
    result = _analyse(comparison, answers, 0.5, with_dprimes=False)
    single = [row for name, some in answers.items() for row in _dprimes(name, list(some))]
    pooled = {row.what: row for row in _dprimes("pooled", together(answers))}
    dprimes = [*single, *(over_participants(single, pooled, bounds=(0.0, inf)) if len(answers) > 1 else ())]
    return replace(result, rows=[*result.rows, *dprimes])


def _dprimes(name: str, answers: list[Answer]) -> list[Row]:
    rows: list[Row] = []
    for what, cell in grouped(answers, lambda each: What(DPRIME, each.condition, each.other or "")).items():
        different = [each for each in cell if each.target == DIFFERENT]
        equal = [each for each in cell if each.target == SAME]
        hits, alarms = ([each.response for each in some].count(DIFFERENT) for some in (different, equal))
        estimate = sensitivity.same_different(hits, len(different), alarms, len(equal))
        rows.append(Row(what, name, estimate, "", len(cell), None, 0.0))
    return rows


def with_dprime(row: Row, comparison: Comparison) -> Row:
    """Return the row of d' that belongs to a row of proportions.

    All right, or all wrong, counts as half an answer less (Macmillan & Kaplan 1985); the bounds are not corrected.
    """
    inverse = {
        "same": sensitivity.oddity,
        "name": lambda proportion: sensitivity.naming(proportion, len(comparison.names)),
    }.get(comparison.question, sensitivity.two_afc)
    edge = 0.5 / max(row.trials, 1)
    found = row.estimate.mapped(inverse)
    value = inverse(min(max(row.estimate.value, edge), 1 - edge)) if row.estimate.value == row.estimate.value else nan
    return replace(row, what=row.what._replace(measure=DPRIME), estimate=Estimate(value, *found[1:]), chance=0.0)


def _analyse(comparison: Comparison, answers: ByParticipant, chance: float, with_dprimes: bool = True) -> Result:
    def rows_of(name: str, some: list[Answer]) -> list[Row]:
        cells = grouped(some, lambda each: What(CORRECT, label(each), each.other or ""))
        return [
            proportion_row(what, name, [each.correct or 0 for each in cell], chance, one_sided=True)
            for what, cell in cells.items()
        ]

    single = [row for name, some in answers.items() for row in rows_of(name, list(some))]
    pooled = {row.what: row for row in rows_of("pooled", together(answers))}
    rows = [*single, *(over_participants(single, pooled) if len(answers) > 1 else ())]
    between = contrasts(CORRECT, rows, pooled) if comparison.question == "name" else []
    dprimes = [with_dprime(row, comparison) for row in rows] if with_dprimes else []
    return Result(comparison.name, comparison.question, list(answers), [*rows, *dprimes, *between], CORRECT)
