"""Procedures whose trials are known from the start: they compare two things, or have one interval."""

from abc import abstractmethod
from dataclasses import replace
from functools import partial
from itertools import product
from typing import final

import numpy as np

from ..design import DIFFERENT, SAME, Comparison, Stimulus, Trial
from .procedure import (
    Cell,
    Course,
    Listed,
    Procedure,
    asks,
    cell_stimuli,
    compared_cells,
    comparison_trial,
    in_rounds,
    without_levels,
)


class Pairs(Procedure):
    """A procedure whose trials are known from the start: each pair equally often, in rounds."""

    @abstractmethod
    def trial(self, comparison: Comparison, cell: Cell, number: int) -> Trial:
        """Return one of the arrangements of a pair, by a number."""

    def course(self, comparison: Comparison, generator: np.random.Generator) -> Course:
        make = partial(self.trial, comparison)
        return Listed(in_rounds(compared_cells(comparison), comparison.repetitions, generator, make))

    def stimuli(self, comparison: Comparison) -> tuple[Stimulus, ...]:
        return cell_stimuli(compared_cells(comparison))

    def trials(self, comparison: Comparison) -> int:
        return comparison.repetitions * len(compared_cells(comparison))


@final
class TwoAfc(Pairs):
    """Two-interval forced choice: each pair of conditions, or each level and the standard, equally often."""

    def refusal(self, comparison: Comparison) -> str:
        return asks(comparison, "2afc")

    def trial(self, comparison: Comparison, cell: Cell, number: int) -> Trial:
        return comparison_trial(comparison, "2afc", cell, 1 + number % 2)


@final
class Constant(Pairs):
    """Constant stimuli: each level is compared with the standard equally often, in two intervals."""

    def refusal(self, comparison: Comparison) -> str:
        return asks(comparison, "constant") or without_levels(comparison)

    def trial(self, comparison: Comparison, cell: Cell, number: int) -> Trial:
        return comparison_trial(comparison, "constant", cell, 1 + number % 2)


@final
class Oddity(Pairs):
    """Three-interval oddity: two intervals are equal, and the participant names the third.

    Each of a pair is the odd one equally often in each interval; `condition` and `level` are those of the pair's first,
    whichever is odd.
    """

    def refusal(self, comparison: Comparison) -> str:
        return standard_among_levels(comparison) or asks(comparison, "oddity")

    def trial(self, comparison: Comparison, cell: Cell, number: int) -> Trial:
        return odd_one(comparison, "oddity", cell, number)


@final
class SameDifferent(Pairs):
    """Same or different: two intervals, of which half of the trials have the same twice.

    It needs fewer intervals than `oddity`, but participants differ in how readily they say that something is different;
    d' takes that into account.
    """

    def refusal(self, comparison: Comparison) -> str:
        if comparison.levels:
            return "compares conditions and no levels; for levels, ask `same` or `higher`"
        return asks(comparison, "same-different")

    def trial(self, comparison: Comparison, cell: Cell, number: int) -> Trial:
        one, other = cell
        intervals = ((one, other), (one, one), (other, one), (other, other))[number % 4]
        target = SAME if number % 2 else DIFFERENT
        names = comparison.name, comparison.question, "same-different"
        return Trial(*names, intervals, (SAME, DIFFERENT), one.condition, other.condition, target=target)


def odd_one(comparison: Comparison, procedure: str, cell: Cell, number: int) -> Trial:
    """Return one of the six arrangements of a pair in three intervals, by a number."""
    trial = comparison_trial(comparison, procedure, cell, 1 + number % 3, intervals=3)
    if number // 3 % 2 == 0:
        return trial
    others = {cell.test: cell.against, cell.against: cell.test}
    return replace(trial, intervals=tuple(others[interval] for interval in trial.intervals))


def standard_among_levels(comparison: Comparison) -> str:
    """Return a complaint about a standard that is one of the levels; "" if it is not."""
    if comparison.levels and comparison.standard in comparison.levels:
        return "cannot tell the standard from itself; leave the `standard:` out of the `levels:`"
    return ""


@final
class Adjustment(Procedure):
    """Adjustment: the participant changes the second interval until it is equal to the first, the standard.

    Trials begin at the least and at the greatest level in turn; the response is the level that was set.
    """

    def refusal(self, comparison: Comparison) -> str:
        return asks(comparison, "adjustment") or without_levels(comparison)

    def course(self, comparison: Comparison, generator: np.random.Generator) -> Course:
        def make(name: str, number: int) -> Trial:
            start, standard = comparison.levels[-(number % 2)], comparison.standard
            names = comparison.name, comparison.question, "adjustment"
            intervals, choices = (Stimulus(name, standard), Stimulus(name, start)), tuple(map(repr, comparison.levels))
            return Trial(*names, intervals, choices, name, level=start, standard=standard)

        return Listed(in_rounds(comparison.conditions, comparison.repetitions, generator, make))

    def stimuli(self, comparison: Comparison) -> tuple[Stimulus, ...]:
        levels = (comparison.standard, *comparison.levels)
        return tuple(dict.fromkeys(Stimulus(name, level) for name in comparison.conditions for level in levels))


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
