"""The method of constant stimuli."""

from typing import final

import numpy as np

from ..design.study import Comparison
from .cells import asks, cells_of, comparison_trial, in_rounds, stimuli_of, without_levels
from .procedure import Course, Listed, Procedure, Stimulus


@final
class Constant(Procedure):
    """Constant stimuli: each level is compared with the standard equally often, in two intervals."""

    def refusal(self, comparison: Comparison) -> str:
        """Return what is missing: levels, a standard, or a question about more."""
        return asks(comparison, "rougher", "higher") or without_levels(comparison)

    def course(self, comparison: Comparison, generator: np.random.Generator) -> Course:
        """Return all trials in rounds; a level comes first and second equally often."""
        cells = cells_of(comparison)
        trials = in_rounds(
            cells,
            comparison.repetitions,
            generator,
            lambda cell, number: comparison_trial(comparison, "constant", cell, 1 + number % 2),
        )
        return Listed(trials)

    def stimuli(self, comparison: Comparison) -> tuple[Stimulus, ...]:
        """Return all levels and the standard, in each condition."""
        return stimuli_of(cells_of(comparison))

    def trials(self, comparison: Comparison) -> int:
        """Return the number of trials."""
        return comparison.repetitions * len(cells_of(comparison))
