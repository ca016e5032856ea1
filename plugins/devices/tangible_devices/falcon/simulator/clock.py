"""The time of a simulation: as fast as it can be computed, or that of the wall."""

import time
from abc import ABC, abstractmethod
from typing import final


class Clock(ABC):
    """Seconds since the start, never going back."""

    @abstractmethod
    def __call__(self) -> float:
        """Now."""

    @abstractmethod
    def wait_until(self, moment_s: float) -> None:
        """Return at this moment, at once if it is over."""


@final
class SimulatedClock(Clock):
    """Time goes on only by waiting."""

    def __init__(self) -> None:
        self._now_s = 0.0

    def __call__(self) -> float:
        """The last moment that was waited for."""
        return self._now_s

    def wait_until(self, moment_s: float) -> None:
        """Make it this moment."""
        self._now_s = max(self._now_s, moment_s)


@final
class RealClock(Clock):
    """Time goes on by itself."""

    def __init__(self) -> None:
        self._start_s = time.perf_counter()

    def __call__(self) -> float:
        """Seconds since this clock was made."""
        return time.perf_counter() - self._start_s

    def wait_until(self, moment_s: float) -> None:
        """Sleep until then."""
        if (left_s := moment_s - self()) > 0:
            time.sleep(left_s)
