"""Whether the last interval is equal to the first, which the participant adjusts until it is."""

from collections.abc import Callable
from typing import ClassVar

import numpy as np

from ...design import Comparison, Stimulus, Trial
from ...measures.functions import Threshold, equal_level
from ...measures.rows import ByParticipant, Result, Row, interval
from ...measures.shares import analyse_quantities
from ...statistics.psychometric import GAUSSIAN
from ..question import Percept, Question

MORE, LESS, EQUAL = "1", "2", "3"


class Equal(Question):
    """A level that is set."""

    sentence = "Was interval 2 equal to interval 1?"
    about = "adjust the last interval until it is equal to the first"
    procedures: ClassVar[tuple[str, ...]] = ("adjustment",)
    has_threshold = True

    def choices(self, trial: Trial, comparison: Comparison) -> dict[str, str]:
        return {MORE: "no, it needs more", LESS: "no, it needs less", EQUAL: "yes, it was equal"}

    def response(self, trial: Trial, key: str, level: float | None) -> str:
        return repr(level)

    def next_level(self, trial: Trial, key: str, level: float | None) -> float | None:
        levels = [float(choice) for choice in trial.choices]
        if key == EQUAL or level is None:
            return None
        return levels[min(max(levels.index(level) + (1 if key == MORE else -1), 0), len(levels) - 1)]

    def decide(self, trial: Trial, percept: Percept, generator: np.random.Generator) -> str:
        percept_of_standard = float(percept.strengths[0]) + float(generator.standard_normal())
        return _nearest(percept_of_standard, trial, lambda level: percept.magnitude(Stimulus(trial.condition, level)))

    def draw(self, trial: Trial, comparison: Comparison, truth: Threshold, generator: np.random.Generator) -> str:
        return _nearest(generator.normal(equal_level(comparison, truth), truth.width / GAUSSIAN), trial)

    def analyse_conditions(self, comparison: Comparison, answers: ByParticipant) -> Result:
        standard, unit = comparison.standard or 0.0, comparison.unit
        return analyse_quantities(
            comparison,
            answers,
            "constant error",
            origin=standard,
            chance=0.0,
            unit=unit,
            about=lambda each: each.condition,
        )

    def describe(self, row: Row, who: str) -> str:
        (value, low, high), one = row.estimate, row.what.condition
        side = "above" if value > 0 else "below"
        went = f"{who} went {abs(value):.3g} {row.unit} {side} the standard on average"
        return f"With {one}, {went} ({interval(low, high)})."


def _nearest(target: float, trial: Trial, scale: Callable[[float], float] = float) -> str:
    """Return the level that can be set that is nearest to what is wanted, on a scale of its own."""
    return min(trial.choices, key=lambda choice: abs(scale(float(choice)) - target))


QUESTION = Equal()
