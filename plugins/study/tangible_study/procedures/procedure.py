"""The interface of procedures, which trial is next; those that are installed; and the pieces that they share."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Sequence
from itertools import combinations
from typing import Any, NamedTuple, TypeVar, cast, final

import numpy as np

from tangible_core.errors import BrokenMethod, UnknownName, shown
from tangible_core.scene import Section

from ..design import Comparison, Stimulus, Trial
from ..points import QUESTIONS, points
from ..questions import load_question
from ..questions.question import Score


def score(trial: Trial, response: str) -> Score:
    """Return what a response means: the condition or level that it chose, and whether it is right.

    >>> score(Trial("a", "same", "oddity", (), ("1", "2", "3"), "x", "y", position=3), "3")
    Score(chosen=None, correct=1)
    """
    return load_question(trial.question).score(trial, response)


class Course(ABC):
    """The course of a procedure with one participant. Its state follows from the answers that it was given."""

    @abstractmethod
    def next(self) -> Trial | None:
        """Return the next trial; the same one until it is answered, and None at the end."""

    @abstractmethod
    def take(self, trial: Trial, response: str) -> None:
        """Take the response to the trial that `next` returned."""


class Procedure(Section, ABC):
    """A procedure by its options, which are its fields; `tangible.procedure` is the group of its entry point.

    The same comparison, seed and answers must give the same trials: a study resumes by answering them again.
    """

    @abstractmethod
    def refusal(self, comparison: Comparison) -> str:
        """Return why a comparison cannot be run by this procedure, with the cure; "" if it can."""

    @abstractmethod
    def course(self, comparison: Comparison, generator: np.random.Generator) -> Course:
        """Begin with a participant. generator: the only source of chance."""

    @abstractmethod
    def stimuli(self, comparison: Comparison) -> tuple[Stimulus, ...]:
        """Return everything that may be presented, each once, so that it is made and checked before."""

    def trials(self, comparison: Comparison) -> int:
        """Return the number of trials with one participant."""
        return comparison.repetitions * len(comparison.conditions)


@final
class Listed(Course):
    """A course of trials that are known from the start."""

    def __init__(self, trials: Iterable[Trial]) -> None:
        self._trials = list(trials)
        self._at = 0

    def next(self) -> Trial | None:
        return self._trials[self._at] if self._at < len(self._trials) else None

    def take(self, trial: Trial, response: str) -> None:
        self._at += 1


def procedure_names() -> list[str]:
    """Return the names of all installed procedures, ours first. Nothing is imported."""
    return list(points())


def load_procedure(name: str) -> type[Procedure]:
    """Import the class of a procedure; its fields are its options. Raises: UnknownName, BrokenMethod."""
    there = points()
    if name not in there:
        raise UnknownName("procedure", name, there)
    try:
        procedure = cast(Any, there[name].load())
    except (Exception, SystemExit) as error:
        raise BrokenMethod(
            f"procedure {name!r} ({there[name].value}) cannot be loaded: {type(error).__name__}: "
            f"{shown(str(error), 500)}; repair or remove its package"
        ) from error
    if not (isinstance(procedure, type) and issubclass(procedure, Procedure)):
        raise BrokenMethod(f"procedure {name!r} ({there[name].value}) is not a Procedure")
    return procedure


T = TypeVar("T")


class Cell(NamedTuple):
    """Two things that are compared: one under test, and the one that it is compared with."""

    test: Stimulus
    against: Stimulus


def compared_cells(comparison: Comparison) -> list[Cell]:
    """Return each level against the standard, for each condition; without levels, each pair of conditions."""
    if comparison.levels:
        return [
            Cell(Stimulus(name, level), Stimulus(name, comparison.standard))
            for name in comparison.conditions
            for level in comparison.levels
        ]
    return [Cell(Stimulus(one), Stimulus(other)) for one, other in combinations(comparison.conditions, 2)]


def cell_stimuli(cells: Iterable[Cell]) -> tuple[Stimulus, ...]:
    """Return everything that cells present, each once."""
    return tuple(dict.fromkeys(stimulus for cell in cells for stimulus in cell))


def comparison_trial(comparison: Comparison, procedure: str, cell: Cell, position: int, intervals: int = 2) -> Trial:
    """Return a trial in which the test is in one interval, and what it is compared with in all others."""
    test, against = cell
    return Trial(
        comparison.name,
        comparison.question,
        procedure,
        tuple(test if number == position else against for number in range(1, intervals + 1)),
        tuple(map(str, range(1, intervals + 1))),
        test.condition,
        against.condition if against.condition != test.condition else None,
        test.level,
        against.level,
        position,
    )


def in_rounds(
    things: Sequence[T], repetitions: int, generator: np.random.Generator, make: Callable[[T, int], Trial]
) -> list[Trial]:
    """Return trials in rounds: each has everything once, in random order, so that fatigue meets all alike."""
    starts = generator.integers(0, 1 << 16, len(things)).tolist()
    return [
        make(things[index], starts[index] + turn)
        for turn in range(repetitions)
        for index in generator.permutation(len(things)).tolist()
    ]


def without_levels(comparison: Comparison) -> str:
    """Return what is missing for a comparison of levels with a standard; "" if nothing is."""
    if not comparison.vary or len(comparison.levels) < 1 or comparison.standard is None:
        return "write the key that varies (`vary:`), its `levels:` and the `standard:` that each is compared with"
    return ""


def asks(comparison: Comparison, procedure: str) -> str:
    """Return a complaint if a procedure of ours cannot ask the question of this comparison; "" if it can."""
    if procedure in load_question(comparison.question).procedures:
        return ""
    others = [name for name in QUESTIONS if procedure in load_question(name).procedures]
    return f"does not ask for {comparison.question!r}; it asks for {' or '.join(others)}"
