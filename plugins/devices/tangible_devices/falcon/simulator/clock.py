"""Clocks of a simulation: as fast as it can be computed, or real time."""

import time


class SimulatedClock:
    """A clock of seconds since the start, which advances only when it is waited for."""

    def __init__(self) -> None:
        self._now_s = 0.0

    def __call__(self) -> float:
        """Return the last moment that was waited for."""
        return self._now_s

    def wait_until(self, moment_s: float) -> None:
        """Set the time to this moment, unless it has passed."""
        self._now_s = max(self._now_s, moment_s)


class RealClock(SimulatedClock):
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
