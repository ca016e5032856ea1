"""Which part was felt."""

from collections.abc import Mapping
from typing import ClassVar

import numpy as np

from ...design import Comparison, Trial
from ...measures.rows import ByParticipant, Result, Row, share
from ...measures.shares import CORRECT, analyse_right_answers
from ...statistics import sensitivity
from ..question import Percept, Question


class Name(Question):
    """The name of a part to which the hand is led."""

    sentence = "Which part was this?"
    about = "which part is this"
    procedures: ClassVar[tuple[str, ...]] = ("naming",)
    names_parts = True
    nouns: ClassVar[Mapping[str, str]] = {CORRECT: "the share of parts named rightly"}

    def choices(self, trial: Trial, comparison: Comparison) -> dict[str, str]:
        return {str(number): name for number, name in enumerate(trial.choices, 1)}

    def response(self, trial: Trial, key: str, level: float | None) -> str:
        return trial.choices[int(key) - 1]

    def decide(self, trial: Trial, percept: Percept, generator: np.random.Generator) -> str:
        evidence = generator.standard_normal(len(trial.choices))
        strength = max(percept.base + percept.magnitude(trial.intervals[0]), 0.0)
        evidence[trial.choices.index(trial.target or "")] += strength
        return trial.choices[int(np.argmax(evidence))]

    def analyse_conditions(self, comparison: Comparison, answers: ByParticipant) -> Result:
        count = len(comparison.names)
        return analyse_right_answers(
            comparison,
            answers,
            1 / count,
            lambda proportion: sensitivity.naming(proportion, count),
            with_contrasts=True,
        )

    def describe(self, row: Row, who: str) -> str:
        guess = f"guessing gives {100 * row.chance:.0f} %."
        return f"With {row.what.condition}, {who} named the right part in {share(row)}; {guess}"


QUESTION = Name()
