"""The odd one out of three intervals."""

from dataclasses import replace
from typing import final

import numpy as np

from ..design.study import Comparison
from .cells import Cell, asks, cells_of, comparison_trial, in_rounds, stimuli_of
from .procedure import Course, Listed, Procedure, Stimulus, Trial


@final
class Oddity(Procedure):
    """Three-interval oddity: two intervals are equal, and the participant names the third.

    Each of a pair is the odd one equally often in each interval; `condition` and `level` are those of the pair's first,
    whichever is odd.
    """

    def refusal(self, comparison: Comparison) -> str:
        """Return what is missing: the question, or two things that may differ."""
        if comparison.levels and comparison.standard in comparison.levels:
            return "cannot tell the standard from itself; leave the `standard:` out of the `levels:`"
        return asks(comparison, "same")

    def course(self, comparison: Comparison, generator: np.random.Generator) -> Course:
        """Return all trials in rounds."""
        return Listed(
            in_rounds(
                cells_of(comparison),
                comparison.repetitions,
                generator,
                lambda cell, number: odd_one(comparison, "oddity", cell, number),
            )
        )

    def stimuli(self, comparison: Comparison) -> tuple[Stimulus, ...]:
        """Return both of each pair."""
        return stimuli_of(cells_of(comparison))

    def trials(self, comparison: Comparison) -> int:
        """Return the number of trials."""
        return comparison.repetitions * len(cells_of(comparison))


def odd_one(comparison: Comparison, procedure: str, cell: Cell, number: int) -> Trial:
    """Return one of the six arrangements of a pair in three intervals, by a number."""
    trial = comparison_trial(comparison, procedure, cell, 1 + number % 3, intervals=3)
    if number // 3 % 2 == 0:
        return trial
    others = {cell.test: cell.against, cell.against: cell.test}
    return replace(trial, intervals=tuple(others[each] for each in trial.intervals))
