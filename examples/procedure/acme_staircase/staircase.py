"""A staircase of levels."""

from typing import Annotated

import numpy as np
from pydantic import Field

from tangible_study.design import Comparison
from tangible_study.procedures import Course, Procedure, Stimulus, Trial, score


class Staircase(Procedure):
    """Staircase: some right answers in a row make it harder, each wrong one easier (Levitt, JASA 49, 1971)."""

    in_a_row: Annotated[int, Field(ge=1, le=4)] = 2
    """Right answers until the next lower level; with 2, it stays where 71 % of the answers are right."""

    def refusal(self, comparison: Comparison) -> str:
        """Return what is missing."""
        if comparison.question != "higher" or comparison.standard is None or not comparison.levels:
            return "asks which one is higher; write `question: higher`, `levels:` and a `standard:`"
        if comparison.levels[0] <= comparison.standard:
            return "goes down to the standard; write `levels:` above it"
        return ""

    def stimuli(self, comparison: Comparison) -> tuple[Stimulus, ...]:
        """Return all levels and the standard, of the first condition."""
        return tuple(Stimulus(comparison.conditions[0], each) for each in (comparison.standard, *comparison.levels))

    def course(self, comparison: Comparison, generator: np.random.Generator) -> Course:
        """Begin at the greatest level."""
        return Steps(self.in_a_row, comparison, generator.integers(1, 3, comparison.repetitions).tolist())

    def trials(self, comparison: Comparison) -> int:
        """Return the number of trials."""
        return comparison.repetitions


class Steps(Course):
    """The way of one participant over the levels."""

    def __init__(self, in_a_row: int, comparison: Comparison, positions: list[int]) -> None:
        self.in_a_row, self.comparison, self.positions = in_a_row, comparison, positions
        self.at, self.done, self.right = len(comparison.levels) - 1, 0, 0

    def next(self) -> Trial | None:
        """Return a trial with the level of this step, in the first interval or the second."""
        if self.done == len(self.positions):
            return None
        each, position = self.comparison, self.positions[self.done]
        test, standard = (Stimulus(each.conditions[0], level) for level in (each.levels[self.at], each.standard))
        return Trial(
            comparison=each.name,
            question=each.question,
            procedure="acme-staircase",
            intervals=(test, standard) if position == 1 else (standard, test),
            choices=("1", "2"),
            condition=each.conditions[0],
            level=test.level,
            standard=standard.level,
            position=position,
        )

    def take(self, trial: Trial, response: str) -> None:
        """Step down after some right answers, and up after a wrong one."""
        self.done += 1
        self.right = self.right + 1 if score(trial, response).correct else 0
        step = 1 if self.right == 0 else -1 if self.right == self.in_a_row else 0
        self.right %= self.in_a_row
        self.at = min(max(self.at + step, 0), len(self.comparison.levels) - 1)
