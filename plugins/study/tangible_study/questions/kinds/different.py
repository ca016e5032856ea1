"""Whether two intervals were the same, or different."""

from dataclasses import replace
from math import inf
from typing import ClassVar

import numpy as np

from ...design import DIFFERENT, SAME, Comparison, Trial
from ...measures.rows import ByParticipant, Result, Row, What, discrimination_in_words, group_answers, of_each_and_all
from ...measures.shares import DPRIME, analyse_right_answers
from ...statistics import sensitivity
from ...trials import Answer
from ..question import Percept, Question

CRITERION = 1.5
"""Difference from which two intervals are called different, in standard deviations of the noise of one."""


class Different(Question):
    """Two intervals that may be the same."""

    sentence = "Were the two intervals the same, or different?"
    about = "were the two intervals the same, or different"
    procedures: ClassVar[tuple[str, ...]] = ("same-different",)

    def choices(self, trial: Trial, comparison: Comparison) -> dict[str, str]:
        return {"1": "they were the same", "2": "they were different"}

    def response(self, trial: Trial, key: str, level: float | None) -> str:
        return trial.choices[int(key) - 1]

    def decide(self, trial: Trial, percept: Percept, generator: np.random.Generator) -> str:
        return DIFFERENT if abs(percept.strengths[0] - percept.strengths[1]) > CRITERION else SAME

    def analyse_conditions(self, comparison: Comparison, answers: ByParticipant) -> Result:
        result = analyse_right_answers(comparison, answers, 0.5)
        dprimes, _ = of_each_and_all(_dprimes, answers, bounds=(0.0, inf))
        return replace(result, rows=[*result.rows, *dprimes])

    def describe(self, row: Row, who: str) -> str:
        return discrimination_in_words(row, f"{who} answered rightly")


def _dprimes(name: str, answers: list[Answer]) -> list[Row]:
    rows: list[Row] = []
    for what, cell in group_answers(answers, lambda answer: What(DPRIME, answer.condition, answer.other or "")).items():
        different = [answer for answer in cell if answer.target == DIFFERENT]
        equal = [answer for answer in cell if answer.target == SAME]
        hits, alarms = ([answer.response for answer in some].count(DIFFERENT) for some in (different, equal))
        estimate = sensitivity.same_different(hits, len(different), alarms, len(equal))
        rows.append(Row(what, name, estimate, "", len(cell), None, 0.0))
    return rows


QUESTION = Different()
