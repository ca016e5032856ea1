"""The method of adjustment."""

from typing import final

import numpy as np

from ..design import Comparison, Stimulus, Trial
from .cells import asks, in_rounds, without_levels
from .procedure import Course, Listed, Procedure


@final
class Adjustment(Procedure):
    """Adjustment: the participant changes the second interval until it is equal to the first, the standard.

    Trials begin at the least and at the greatest level in turn; the response is the level that was set.
    """

    def refusal(self, comparison: Comparison) -> str:
        """Return what is missing: levels, a standard, or the question."""
        return asks(comparison, "adjustment") or without_levels(comparison)

    def course(self, comparison: Comparison, generator: np.random.Generator) -> Course:
        """Return all trials in rounds."""

        def make(name: str, number: int) -> Trial:
            start, standard = comparison.levels[-(number % 2)], comparison.standard
            names = comparison.name, comparison.question, "adjustment"
            intervals, choices = (Stimulus(name, standard), Stimulus(name, start)), tuple(map(repr, comparison.levels))
            return Trial(*names, intervals, choices, name, level=start, standard=standard)

        return Listed(in_rounds(comparison.conditions, comparison.repetitions, generator, make))

    def stimuli(self, comparison: Comparison) -> tuple[Stimulus, ...]:
        """Return all levels and the standard, in each condition."""
        levels = (comparison.standard, *comparison.levels)
        return tuple(dict.fromkeys(Stimulus(name, level) for name in comparison.conditions for level in levels))
