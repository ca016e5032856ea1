"""Pieces that procedures share: balanced positions, rounds in random order, and complaints about missing keys."""

from collections.abc import Callable, Iterable, Sequence
from itertools import combinations
from typing import NamedTuple, TypeVar

import numpy as np

from ..design import Comparison, Stimulus, Trial
from ..points import QUESTIONS
from ..questions import load_question

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
