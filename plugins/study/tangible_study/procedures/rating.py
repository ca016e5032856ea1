"""Ratings of one interval on a scale."""

from typing import final

import numpy as np

from ..design.study import Comparison
from .cells import asks, in_rounds, one_interval
from .procedure import Course, Listed, Procedure, Stimulus, Trial


@final
class Rating(Procedure):
    """Rating: one interval, and a whole number on a scale."""

    def refusal(self, comparison: Comparison) -> str:
        """Return what is missing: the question, or a scale of two numbers."""
        if comparison.scale.least >= comparison.scale.most:
            return "has a scale of less than two numbers; make `most:` greater than `least:`"
        return asks(comparison, "rating")

    def course(self, comparison: Comparison, generator: np.random.Generator) -> Course:
        """Return all trials in rounds."""
        numbers = tuple(map(str, range(comparison.scale.least, comparison.scale.most + 1)))

        def make(stimulus: Stimulus, _: int) -> Trial:
            return one_interval(comparison, "rating", stimulus, numbers)

        return Listed(in_rounds(self.stimuli(comparison), comparison.repetitions, generator, make))

    def stimuli(self, comparison: Comparison) -> tuple[Stimulus, ...]:
        """Return each condition, at each level if there are any."""
        levels = comparison.levels or (None,)
        return tuple(Stimulus(name, level) for name in comparison.conditions for level in levels)

    def trials(self, comparison: Comparison) -> int:
        """Return the number of trials."""
        return comparison.repetitions * len(self.stimuli(comparison))
