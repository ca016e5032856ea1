"""Which of three intervals was not the same as the others."""

from typing import ClassVar

import numpy as np

from ...design import Comparison, Trial
from ...measures.functions import DISTANCE, Function
from ...measures.rows import ByParticipant, Result, Row, discrimination_in_words
from ...measures.shares import analyse_right_answers
from ...statistics import sensitivity
from ..question import Percept, Question


class Same(Question):
    """The odd one of three intervals."""

    sentence = "Which interval was not the same as the others?"
    about = "which interval was not the same as the others"
    procedures: ClassVar[tuple[str, ...]] = ("oddity", "quest")
    intervals = 3
    function: ClassVar[Function | None] = DISTANCE
    has_threshold = True

    def right_answer(self, trial: Trial) -> str:
        return str(trial.position)

    def decide(self, trial: Trial, percept: Percept, generator: np.random.Generator) -> str:
        strengths = percept.strengths
        others = (strengths.sum() - strengths) / (len(strengths) - 1)
        return str(int(np.argmax(np.abs(strengths - others))) + 1)

    def analyse_conditions(self, comparison: Comparison, answers: ByParticipant) -> Result:
        return analyse_right_answers(comparison, answers, 1 / 3, sensitivity.oddity)

    def describe(self, row: Row, who: str) -> str:
        return discrimination_in_words(row, f"{who} found the odd one")


QUESTION = Same()
