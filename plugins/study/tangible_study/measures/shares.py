"""Shares of the trials: how often an answer was right, or a condition was chosen, with its d'."""

from collections.abc import Callable
from dataclasses import replace
from math import nan

from ..design import Comparison
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
    of_each_and_all,
    proportion_row,
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
    compared: bool = False,
) -> Result:
    """Analyse how often an answer was right.

    chance: by guessing. inverse: d' from such a share. compared: whether conditions are compared with each other.
    """

    def rows_of(name: str, some: list[Answer]) -> list[Row]:
        return share_rows(CORRECT, name, some, lambda each: each.correct, chance, one_sided=True)

    rows, pooled = of_each_and_all(rows_of, answers)
    between = contrasts(CORRECT, rows, pooled) if compared else []
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
    cells = grouped(answers, lambda each: What(measure, label(each), each.other or ""))
    return [
        proportion_row(what, name, [hit(each) or 0 for each in cell], chance, one_sided) for what, cell in cells.items()
    ]


def with_dprime(row: Row, inverse: Callable[[float], float]) -> Row:
    """Return the row of d' that belongs to a row of shares. inverse: d' from a share.

    All right, or all wrong, counts as half an answer less (Macmillan & Kaplan 1985); the bounds are not corrected.
    """
    edge = 0.5 / max(row.trials, 1)
    found = row.estimate.mapped(inverse)
    value = inverse(min(max(row.estimate.value, edge), 1 - edge)) if row.estimate.value == row.estimate.value else nan
    return replace(row, what=row.what._replace(measure=DPRIME), estimate=Estimate(value, *found[1:]), chance=0.0)
