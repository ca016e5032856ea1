"""Answers that are numbers: levels that were set, and ratings."""

from collections.abc import Callable
from math import nan

import numpy as np

from tangible_core.errors import ResultsError, quoted

from ..design import Comparison
from ..statistics import intervals
from ..statistics.intervals import Estimate
from ..trials import Answer
from .rows import ByParticipant, Result, Row, What, contrasts, grouped, label, over_participants

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
    """Analyse numbers by their mean, and how conditions differ.

    origin: what they are counted from. chance: their mean by chance alone. about: what belongs together.
    """
    rows: list[Row] = []
    for name, some in answers.items():
        for condition, cell in grouped(some, about).items():
            values = [_number(each) - origin for each in cell]
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
