"""A trial: what is presented, what may be answered, and what would be right."""

from dataclasses import dataclass
from typing import NamedTuple

SAME, DIFFERENT = "same", "different"
"""Responses to two intervals that may be equal."""


class Stimulus(NamedTuple):
    """A surface in an interval: that of a condition, at a level if one varies."""

    condition: str
    level: float | None = None


@dataclass(frozen=True)
class Trial:
    """A trial as a procedure asks for it; what it is called on the screen is its intervals' numbers alone."""

    comparison: str
    question: str
    procedure: str
    intervals: tuple[Stimulus, ...]
    """The stimulus of each interval, in their order."""
    choices: tuple[str, ...]
    """Possible responses; of an adjustment, the levels that can be set, as text."""
    condition: str
    """Name of the condition under test."""
    other: str | None = None
    """Name of the condition with which it is compared."""
    level: float | None = None
    standard: float | None = None
    position: int | None = None
    """Interval, from 1, of the comparison or of the odd one."""
    target: str | None = None
    """Right answer, where it is not the number of an interval: the name of a part, or `same` or `different`."""
    phase: str = "test"
