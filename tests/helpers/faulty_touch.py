"""A force law in plain Python for tests of a force loop: it pushes steadily, and has a fault in one of its ticks."""

import os
import re
import sys
import time
from typing import Any, Literal, NoReturn, final

import numpy as np

from tangible_core.data import NO_FORCE, Force, HapticState, Relief
from tangible_core.plugins.touch import Film, PlainTouch, Touch

Fault = Literal[
    "none",
    "blocks",
    "holds Python",
    "exits",
    "odd error",
    "does not arrive",
    "begins slowly",
    "knows itself",
    "no number",
]


class OddError(Exception):
    """An error that can be pickled but not unpickled, as in many libraries."""

    def __init__(self, what: str, where: str) -> None:
        super().__init__(f"{what} in {where}")


@final
class FaultyTouch(PlainTouch):
    """A force of 1 N upwards below the height 0, until a tick in which the force law blocks, exits or raises.

    The fault "does not arrive": it can be pickled but not unpickled. "begins slowly": its first call takes half a
    second, as if it were compiled then. "knows itself": it refers to itself. "no number": forces are NaN from then on.
    """

    stiffness_n_per_m = 0.0

    def __init__(self, fault: Fault = "none", at: int = 100) -> None:
        self._fault: Fault = fault
        self._at = at
        self._ticks = 0
        self._called = False
        self._itself = (self, np.ones(100_000)) if fault == "knows itself" else None

    def __reduce__(self) -> tuple[Any, ...]:
        return (_raise_lost if self._fault == "does not arrive" else FaultyTouch), (self._fault, self._at)

    def force(self, state: HapticState) -> Force:
        """Return the force. Raises: OddError or SystemExit, if that is the fault."""
        if self._fault == "begins slowly" and not self._called:
            time.sleep(0.5)
        self._called = True
        if state.position_m[2] >= 0:
            return NO_FORCE
        self._ticks += 1
        if self._ticks == self._at:
            self._fail()
        if self._fault == "no number" and self._ticks >= self._at:
            return Force(float("nan"), 0.0, float("inf"))
        return Force(0.0, 0.0, 1.0)

    def _fail(self) -> None:
        if self._fault == "blocks":
            time.sleep(3600)
        if self._fault == "holds Python":
            re.match("(a+)+b", "a" * 60)  # takes for ever, in C
        if self._fault == "exits":
            sys.exit(3)
        if self._fault == "odd error":
            raise OddError("a fault", "the law")


@final
class FaultyFilm(Film):
    """The same law as a film, whose frames change nothing."""

    def __init__(self, fault: Fault, at: int = 100) -> None:
        self._fault: Fault = fault
        self._at = at
        self._touch = FaultyTouch(fault, at)

    def __reduce__(self) -> tuple[Any, ...]:
        return FaultyFilm, (self._fault, self._at)

    @property
    def touch(self) -> Touch:
        """The law."""
        return self._touch

    def show(self, relief: Relief, frame: int) -> None:
        """Show nothing."""

    @property
    def arrived(self) -> bool:
        """Always."""
        return True

    @property
    def dropped(self) -> int:
        """None."""
        return 0


def _raise_lost(*_: object) -> NoReturn:
    raise LookupError(f"the law's data is not in process {os.getpid()}")
