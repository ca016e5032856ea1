"""Answers about levels: psychometric functions of each participant and condition."""

import numpy as np

from tangible_core.errors import TangibleError

from ..design.study import Comparison
from ..statistics.psychometric import JND, Blocks, Curve, fit_choice, fit_difference
from ..trials import Answer
from .pairs import note_on_order
from .rows import ByParticipant, Result, Row, What, contrasts, grouped, over_participants, together

EQUALITY = "point of equality"
THRESHOLD = "threshold"
NOTICEABLE = "just noticeable difference"
WIDTH = "width"


def analyse_levels(comparison: Comparison, answers: ByParticipant) -> Result:
    """Fit a function to the answers of each participant in each condition, and compare the conditions."""
    differences = comparison.question == "same"
    curves: dict[str, Curve] = {}
    blocks: dict[str, Blocks] = {}
    rows: list[Row] = []
    unfit: list[str] = []
    for name, some in answers.items():
        for condition, cell in grouped(some, lambda each: each.condition).items():
            key = f"{name}/{condition}"
            blocks[key] = blocks_of(cell, differences)
            if len(blocks[key].levels) < 2:
                unfit.append(key)
                continue
            curves[key] = _fit(comparison, blocks[key], differences)
            rows += _rows(comparison, name, condition, curves[key], len(cell))
    if not rows:
        raise TangibleError(f"{comparison.name}: has answers at one level only; run it to the end")
    if len(answers) > 1:
        rows += over_participants(rows)
    main = THRESHOLD if differences else EQUALITY
    rows += contrasts(main, rows)
    if not differences:
        rows += contrasts(NOTICEABLE, rows)
    notes = [] if differences else note_on_order(together(answers))
    notes += [f"{each} has answers at one level only, and no function." for each in unfit]
    notes += [
        f"The threshold of {key} is outside the levels that were presented; it is a guess."
        for key, curve in curves.items()
        if not (curve.threshold.is_bound or min(blocks[key].levels) <= curve.threshold.value <= max(blocks[key].levels))
    ]
    return Result(comparison.name, comparison.question, list(answers), rows, main, curves, blocks, notes)


def blocks_of(answers: list[Answer], differences: bool) -> Blocks:
    """Return answers by level; by distance from the standard if differences are looked for."""

    def where(each: Answer) -> float:
        level = each.level or 0.0
        return abs(level - (each.standard or 0.0)) if differences else level

    cells = sorted(grouped(answers, where).items())
    hits = [[(each.correct if differences else each.chosen) or 0 for each in cell] for _, cell in cells]
    return Blocks(
        np.array([level for level, _ in cells], float),
        np.array([sum(each) for each in hits], float),
        np.array([len(each) for each in hits], float),
    )


def _fit(comparison: Comparison, blocks: Blocks, differences: bool) -> Curve:
    levels = np.array(comparison.levels or blocks.levels.tolist())
    if differences:
        distances = np.abs(levels - (comparison.standard or 0.0))
        return fit_difference(blocks, (float(distances.min()), float(distances.max())))
    return fit_choice(blocks, (float(levels.min()), float(levels.max())))


def _rows(comparison: Comparison, name: str, condition: str, curve: Curve, trials: int) -> list[Row]:
    unit = comparison.unit
    if curve.chance:
        return [
            Row(What(THRESHOLD, condition), name, curve.threshold, unit, trials),
            Row(What(WIDTH, condition), name, curve.width, "ln", trials),
        ]
    standard = comparison.standard if comparison.standard is not None else float("nan")
    return [
        Row(What(EQUALITY, condition), name, curve.threshold, unit, trials, None, standard),
        Row(What(NOTICEABLE, condition), name, curve.width.mapped(lambda width: JND * width), unit, trials),
        Row(What(WIDTH, condition), name, curve.width, unit, trials),
    ]
