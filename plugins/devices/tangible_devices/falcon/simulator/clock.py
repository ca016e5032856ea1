"""Clocks of a simulation: as fast as it can be computed, or real time."""

import time
from abc import ABC, abstractmethod
from typing import final


class Clock(ABC):
    """A clock of seconds since the start that never goes back."""

    @abstractmethod
    def __call__(self) -> float:
        """Return the time."""

    @abstractmethod
    def wait_until(self, moment_s: float) -> None:
        """Return at this moment, at once if it has passed."""


@final
class SimulatedClock(Clock):
    """A clock that advances only when it is waited for."""

    def __init__(self) -> None:
        self._now_s = 0.0

    def __call__(self) -> float:
        """Return the last moment that was waited for."""
        return self._now_s

    def wait_until(self, moment_s: float) -> None:
        """Set the time to this moment."""
        self._now_s = max(self._now_s, moment_s)


@final
class RealClock(Clock):
    """A clock of real time."""

    def __init__(self) -> None:
        self._start_s = time.perf_counter()

    def __call__(self) -> float:
        """Return the seconds since this clock was created."""
        return time.perf_counter() - self._start_s

    def wait_until(self, moment_s: float) -> None:
        """Sleep until then."""
        if (left_s := moment_s - self()) > 0:
            time.sleep(left_s)
