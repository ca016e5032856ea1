"""Procedures of one interval: a rating, or the name of a part."""

from abc import abstractmethod
from itertools import product
from typing import final

import numpy as np

from ..design import Comparison, Stimulus, Trial
from .procedure import Course, Listed, Procedure, asks, in_rounds


class Single(Procedure):
    """A procedure of one interval a trial: each condition, at each level if there are any, equally often, in rounds."""

    @abstractmethod
    def choices(self, comparison: Comparison) -> tuple[str, ...]:
        """Return the possible responses."""

    def targets(self, comparison: Comparison) -> tuple[str | None, ...]:
        """Return what is right in the trials of a stimulus, one after the other; None if nothing is."""
        return (None,)

    def course(self, comparison: Comparison, generator: np.random.Generator) -> Course:
        choices = self.choices(comparison)

        def make(thing: tuple[Stimulus, str | None], _: int) -> Trial:
            (condition, level), target = thing
            names = comparison.name, comparison.question, type(self).__name__.lower()
            return Trial(*names, (thing[0],), choices, condition, level=level, target=target)

        things = list(product(self.stimuli(comparison), self.targets(comparison)))
        return Listed(in_rounds(things, comparison.repetitions, generator, make))

    def stimuli(self, comparison: Comparison) -> tuple[Stimulus, ...]:
        return tuple(Stimulus(*pair) for pair in product(comparison.conditions, comparison.levels or (None,)))

    def trials(self, comparison: Comparison) -> int:
        return comparison.repetitions * len(self.stimuli(comparison)) * len(self.targets(comparison))


@final
class Naming(Single):
    """Naming: the hand is pulled gently to a part, feels it, and the participant chooses its name."""

    def refusal(self, comparison: Comparison) -> str:
        if len(set(comparison.names)) < max(2, len(comparison.names)):
            return "write at least two different `names:`, of which the participant chooses one"
        return asks(comparison, "naming")

    def choices(self, comparison: Comparison) -> tuple[str, ...]:
        return comparison.names

    def targets(self, comparison: Comparison) -> tuple[str, ...]:
        return comparison.names


@final
class Rating(Single):
    """Rating: one interval, and a whole number on a scale."""

    def refusal(self, comparison: Comparison) -> str:
        if comparison.scale.least >= comparison.scale.most:
            return "has a scale of less than two numbers; make `most:` greater than `least:`"
        return asks(comparison, "rating")

    def choices(self, comparison: Comparison) -> tuple[str, ...]:
        return tuple(map(str, range(comparison.scale.least, comparison.scale.most + 1)))
