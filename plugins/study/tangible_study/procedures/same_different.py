"""Two intervals that are the same or not."""

from typing import final

import numpy as np

from ..design.study import Comparison
from .cells import Cell, asks, cells_of, in_rounds, stimuli_of
from .procedure import DIFFERENT, SAME, Course, Listed, Procedure, Stimulus, Trial

ARRANGEMENTS = 4
"""Arrangements of a pair: both orders of two that differ, and each with itself."""


@final
class SameDifferent(Procedure):
    """Same or different: two intervals, of which half of the trials have the same twice.

    It needs fewer intervals than `oddity`, but participants differ in how readily they say that something is different;
    d' takes that into account.
    """

    def refusal(self, comparison: Comparison) -> str:
        """Return what is missing: the question; or that levels vary."""
        if comparison.levels:
            return "compares conditions and no levels; for levels, ask `same` or `higher`"
        return asks(comparison, "different")

    def course(self, comparison: Comparison, generator: np.random.Generator) -> Course:
        """Return all trials in rounds; the same and different pairs come equally often."""

        def make(cell: Cell, number: int) -> Trial:
            return _arrangement(comparison, cell, number % ARRANGEMENTS)

        return Listed(in_rounds(cells_of(comparison), comparison.repetitions, generator, make))

    def stimuli(self, comparison: Comparison) -> tuple[Stimulus, ...]:
        """Return both of each pair."""
        return stimuli_of(cells_of(comparison))

    def trials(self, comparison: Comparison) -> int:
        """Return the number of trials."""
        return comparison.repetitions * len(cells_of(comparison))


def _arrangement(comparison: Comparison, cell: Cell, number: int) -> Trial:
    one, other = cell
    return Trial(
        comparison.name,
        comparison.question,
        "same-different",
        ((one, other), (one, one), (other, one), (other, other))[number],
        (SAME, DIFFERENT),
        one.condition,
        other.condition,
        target=DIFFERENT if number % 2 == 0 else SAME,
    )
