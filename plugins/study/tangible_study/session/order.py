"""The course of a participant through a whole study: comparisons in balanced order, training first."""

from collections.abc import Iterable
from dataclasses import replace
from typing import final

import numpy as np

from tangible_core.errors import ResultsError

from ..design import Trial
from ..procedures.procedure import Course, score
from ..study_file import StudyFile
from ..trials import Answer

TRAINING, TEST = 1, 2  # streams of chance for training and for test
SHARED = (
    "phase", "comparison", "question", "procedure", "condition", "other", "level", "standard", "position", "target",
)  # fmt: skip
"""Fields that a trial and its answer have in common."""


def latin_square(count: int, row: int) -> list[int]:
    """Return a row of a balanced Latin square (Williams 1949).

    >>> [latin_square(4, row) for row in range(4)]
    [[0, 3, 1, 2], [1, 0, 2, 3], [2, 1, 3, 0], [3, 2, 0, 1]]
    """
    first = [place // 2 if place % 2 == 0 else count - 1 - place // 2 for place in range(count)]
    order = [(step + row) % count for step in first]
    return order[::-1] if count % 2 and row // count % 2 else order


def comparison_order(file: StudyFile, participant: int) -> list[int]:
    """Return the order of the comparisons for a participant, by their index. participant: number from 0."""
    count = len(file.study.comparisons)
    if file.study.order == "as-written":
        return list(range(count))
    if file.study.order == "random":
        return np.random.default_rng([file.study.seed, participant]).permutation(count).tolist()
    return latin_square(count, participant)


@final
class StudyCourse(Course):
    """All trials of a participant. Its state follows from the study file, the participant's number and the answers."""

    def __init__(self, file: StudyFile, participant: int) -> None:
        """Begin before the first trial. participant: number from 0, in the order of their first trials."""
        self._file = file
        self._remaining = [
            (index, phase)
            for index in comparison_order(file, participant)
            for phase in (TRAINING, TEST)
            if phase == TEST or file.study.comparisons[index].training
        ]
        self._participant = participant
        self._course: Course | None = None
        self._answer_count = 0

    def next(self) -> Trial | None:
        while self._remaining:
            index, phase = self._remaining[0]
            comparison = self._file.study.comparisons[index]
            if self._course is None:
                seed = [self._file.study.seed, self._participant, index, phase]
                procedure = self._file.procedures[comparison.name]
                self._course, self._answer_count = procedure.course(comparison, np.random.default_rng(seed)), 0
            over = phase == TRAINING and self._answer_count >= comparison.training
            if not over and (trial := self._course.next()) is not None:
                return replace(trial, phase="training") if phase == TRAINING else trial
            self._remaining.pop(0)
            self._course = None
        return None

    def take(self, trial: Trial, response: str) -> None:
        assert self._course is not None
        self._course.take(trial, response)
        self._answer_count += 1

    @property
    def trials(self) -> int:
        """Number of all trials of a participant."""
        comparisons = self._file.study.comparisons
        counts = {
            comparison.name: self._file.procedures[comparison.name].trials(comparison) for comparison in comparisons
        }
        return sum(
            counts[comparison.name] + min(comparison.training, counts[comparison.name]) for comparison in comparisons
        )


def replay(course: Course, answers: Iterable[Answer]) -> int:
    """Answer a course by the answers of an earlier start; return their number. Raises: ResultsError if they differ."""
    earlier, in_common = list(answers), {*SHARED} - {"question", "procedure"}
    for answer in earlier:
        trial = course.next()
        if trial is None or any(getattr(trial, name) != getattr(answer, name) for name in in_common):
            raise ResultsError(
                f"trial {answer.trial}: is an answer to another trial than this study asks now; run the study with the "
                "version of the program that began it, which the file next to the answers names"
            )
        course.take(trial, answer.response)
    return len(earlier)


def make_answer(trial: Trial, number: int, response: str, seconds: float) -> Answer:
    """Return the line of the table for a response to a trial. number: of the trial, from 1."""
    choice, correct = score(trial, response)
    answer = {"response": response, "chosen": choice, "correct": correct, "response_time": round(seconds, 4)}
    return Answer(number, **{name: getattr(trial, name) for name in SHARED}, **answer)
