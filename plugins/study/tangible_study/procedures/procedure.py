"""The interface of procedures, which trial is next, given the answers so far; and those that are installed."""

from abc import ABC, abstractmethod
from collections.abc import Iterable
from typing import Any, cast, final

import numpy as np

from tangible_core.errors import BrokenMethod, UnknownName, shown
from tangible_core.scene import Section

from ..design import Comparison, Stimulus, Trial
from ..points import points
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
