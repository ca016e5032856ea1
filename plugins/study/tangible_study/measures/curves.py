"""Answers about levels: psychometric functions of each participant and condition."""

import numpy as np

from tangible_core.errors import TangibleError

from ..design import Comparison
from ..statistics.psychometric import Blocks, Curve
from ..trials import Answer
from .functions import Function
from .rows import ByParticipant, Result, Row, What, contrasts, grouped, over_participants, together


def analyse_levels(comparison: Comparison, answers: ByParticipant, function: Function) -> Result:
    """Fit a function to the answers of each participant in each condition, and compare the conditions."""
    curves: dict[str, Curve] = {}
    blocks: dict[str, Blocks] = {}
    rows: list[Row] = []
    unfit: list[str] = []
    for name, some in answers.items():
        for condition, cell in grouped(some, lambda each: each.condition).items():
            key = f"{name}/{condition}"
            blocks[key] = blocks_of(cell, function)
            if len(blocks[key].levels) < 2:
                unfit.append(key)
                continue
            levels = np.array(comparison.levels) if comparison.levels else blocks[key].levels
            span = function.intensities(levels, comparison.standard)
            curves[key] = function.fit(blocks[key], (float(span.min()), float(span.max())))
            rows += [
                Row(What(measure, condition), name, estimate, unit, len(cell), None, chance)
                for measure, estimate, unit, chance in function.figures(curves[key], comparison)
            ]
    if not rows:
        raise TangibleError(f"{comparison.name}: has answers at one level only; run it to the end")
    if len(answers) > 1:
        rows += over_participants(rows)
    for measure in function.compared:
        rows += contrasts(measure, rows)
    notes = function.notes(together(answers))
    notes += [f"{each} has answers at one level only, and no function." for each in unfit]
    notes += [
        f"The threshold of {key} is outside the levels that were presented; it is a guess."
        for key, curve in curves.items()
        if not (curve.threshold.is_bound or min(blocks[key].levels) <= curve.threshold.value <= max(blocks[key].levels))
    ]
    return Result(comparison.name, comparison.question, list(answers), rows, function.main, curves, blocks, notes)


def blocks_of(answers: list[Answer], function: Function) -> Blocks:
    """Return answers by level, on the axis of the function."""

    def where(each: Answer) -> float:
        return float(function.intensities(np.array([each.level or 0.0]), each.standard)[0])

    cells = sorted(grouped(answers, where).items())
    hits = [[function.hit(each) or 0 for each in cell] for _, cell in cells]
    return Blocks(
        np.array([level for level, _ in cells], float),
        np.array([sum(each) for each in hits], float),
        np.array([len(each) for each in hits], float),
    )
