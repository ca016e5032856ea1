"""The naming of parts."""

from itertools import product
from typing import final

import numpy as np

from ..design.study import Comparison
from .cells import asks, in_rounds, one_interval
from .procedure import Course, Listed, Procedure, Stimulus, Trial


@final
class Naming(Procedure):
    """Naming: the hand is pulled gently to a part, feels it, and the participant chooses its name."""

    def refusal(self, comparison: Comparison) -> str:
        """Return what is missing: the question, or names to choose from."""
        if len(set(comparison.names)) < max(2, len(comparison.names)):
            return "write at least two different `names:`, of which the participant chooses one"
        return asks(comparison, "name")

    def course(self, comparison: Comparison, generator: np.random.Generator) -> Course:
        """Return all trials in rounds."""
        things = list(product(self.stimuli(comparison), comparison.names))

        def make(thing: tuple[Stimulus, str], _: int) -> Trial:
            return one_interval(comparison, "naming", thing[0], comparison.names, thing[1])

        return Listed(in_rounds(things, comparison.repetitions, generator, make))

    def stimuli(self, comparison: Comparison) -> tuple[Stimulus, ...]:
        """Return each condition, at each level if there are any."""
        levels = comparison.levels or (None,)
        return tuple(Stimulus(name, level) for name in comparison.conditions for level in levels)

    def trials(self, comparison: Comparison) -> int:
        """Return the number of trials."""
        return comparison.repetitions * len(self.stimuli(comparison)) * len(comparison.names)
