"""How long measurements will take: a guess from figures that come with the program, corrected by what is done."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from statistics import median

from tangible_core.metrics.measured import measured

from .plan import Measurement

CALLS = 4
"""Of a process whose time is known: a warm-up and three."""
START_S = 1.5
"""Of a process: what it imports takes so long, however few calls follow."""
UNKNOWN_S = 5.0


@dataclass(frozen=True)
class Forecast:
    """What each of several measurements is guessed to take, in order."""

    guessed_s: tuple[float, ...]
    is_of_times: bool = True
    """False where errors alone are wanted, of which nothing is known."""

    @property
    def whole_s(self) -> float:
        """All of them."""
        return sum(self.guessed_s)

    def left_s(self, number: int, taken_s: float) -> float:
        """What is left before measurement `number` begins, the others having taken so long.

        Each of these makes the guess about the rest a better one, for it shows how fast this machine is.
        >>> Forecast((2.0, 2.0, 4.0)).left_s(2, taken_s=6.0)
        6.0
        """
        done_s = sum(self.guessed_s[:number])
        return sum(self.guessed_s[number:]) * (taken_s / done_s if done_s else 1.0)


def forecast(waiting: Sequence[Measurement]) -> Forecast:
    """A guess for these."""
    timed = all(each.job.calls for each in waiting)
    return Forecast(tuple(_guessed_s(each) for each in waiting), timed)


def _guessed_s(each: Measurement) -> float:
    known = _known_s(each.job.kind)
    usual_s = known.get(each.job.use, median(known.values()) if known else UNKNOWN_S)
    calls_s = max(0.0, usual_s - START_S) * (each.job.warmups + each.job.calls) / CALLS
    return min(usual_s, START_S) + calls_s


def _known_s(kind: str) -> Mapping[str, float]:
    found = measured().get(kind)
    return {} if found is None else found.process_s
