"""A forecast of how long measurements will take, from figures in the program, corrected by finished measurements."""

from collections.abc import Sequence
from dataclasses import dataclass
from statistics import median

from tangible_core.metrics import load_measured

from .plan import Measurement

CALLS = 4
"""The number of calls in the processes of `measured.json`: a warm-up and three timed calls."""
START_S = 1.5
"""The time in which a process starts and imports, seconds."""
UNKNOWN_S = 5.0
"""The forecast for a process if nothing is known of its kind of method, seconds."""


@dataclass(frozen=True)
class Forecast:
    """The expected times of several measurements, in order."""

    expected_s: tuple[float, ...]
    has_times: bool = True
    """False if errors alone are measured; for these no forecast is known."""

    @property
    def whole_s(self) -> float:
        """The expected time of all measurements."""
        return sum(self.expected_s)

    def left_s(self, number: int, taken_s: float) -> float:
        """Return the time that is left before measurement `number`, if the earlier ones took `taken_s`.

        Finished measurements correct the forecast of the rest, as they show how fast this machine is.
        >>> Forecast((2.0, 2.0, 4.0)).left_s(2, taken_s=6.0)
        6.0
        """
        done_s = sum(self.expected_s[:number])
        return sum(self.expected_s[number:]) * (taken_s / done_s if done_s else 1.0)


def forecast(waiting: Sequence[Measurement]) -> Forecast:
    """Return the forecast for these measurements."""
    has_times = all(each.job.calls for each in waiting)
    return Forecast(tuple(_expected_s(each) for each in waiting), has_times)


def _expected_s(each: Measurement) -> float:
    figures = load_measured().get(each.job.kind)
    known = {} if figures is None else figures.process_s
    usual_s = known.get(each.job.use, median(known.values()) if known else UNKNOWN_S)
    calls_s = max(0.0, usual_s - START_S) * (each.job.warmups + each.job.calls) / CALLS
    return min(usual_s, START_S) + calls_s
