"""The choice between two intervals."""

from typing import final

import numpy as np

from ..design.study import Comparison
from .cells import asks, cells_of, comparison_trial, in_rounds, stimuli_of
from .procedure import Course, Listed, Procedure, Stimulus


@final
class TwoAfc(Procedure):
    """Two-interval forced choice: each pair of conditions, or each level and the standard, equally often."""

    def refusal(self, comparison: Comparison) -> str:
        """Return what is missing: a question about more."""
        return asks(comparison, "rougher", "higher")

    def course(self, comparison: Comparison, generator: np.random.Generator) -> Course:
        """Return all trials in rounds; both of a pair come first equally often."""
        trials = in_rounds(
            cells_of(comparison),
            comparison.repetitions,
            generator,
            lambda cell, number: comparison_trial(comparison, "2afc", cell, 1 + number % 2),
        )
        return Listed(trials)

    def stimuli(self, comparison: Comparison) -> tuple[Stimulus, ...]:
        """Return both of each pair."""
        return stimuli_of(cells_of(comparison))

    def trials(self, comparison: Comparison) -> int:
        """Return the number of trials."""
        return comparison.repetitions * len(cells_of(comparison))
