"""A whole number on a scale."""

from collections.abc import Mapping
from typing import ClassVar

import numpy as np

from ...design import Comparison, Trial
from ...measures.rows import ByParticipant, Result, Row, interval
from ...measures.shares import analyse_quantities
from ..question import Percept, Question

RATING = "mean rating"


class Rating(Question):
    """A rating."""

    sentence = "Which number fits best?"
    about = "a whole number on a scale"
    procedures: ClassVar[tuple[str, ...]] = ("rating",)
    nouns: ClassVar[Mapping[str, str]] = {RATING: "the rating"}

    def ask(self, comparison: Comparison) -> str:
        return f"How would you rate {comparison.scale.of}?" if comparison.scale.of else self.sentence

    def choices(self, trial: Trial, comparison: Comparison) -> dict[str, str]:
        ends = comparison.scale.ends or ("", "")
        return dict.fromkeys(trial.choices, "") | {trial.choices[0]: ends[0], trial.choices[-1]: ends[1]}

    def decide(self, trial: Trial, percept: Percept, generator: np.random.Generator) -> str:
        middle = (len(trial.choices) - 1) / 2
        return trial.choices[int(np.clip(round(middle + float(percept.strengths[0])), 0, len(trial.choices) - 1))]

    def analyse_conditions(self, comparison: Comparison, answers: ByParticipant) -> Result:
        return analyse_quantities(comparison, answers, RATING)

    def describe(self, row: Row, who: str) -> str:
        value, low, high = row.estimate
        return f"{who} gave {row.what.condition} a rating of {value:.3g} on average ({interval(low, high)})."


QUESTION = Rating()
