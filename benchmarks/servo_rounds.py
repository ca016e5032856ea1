"""What loops counted in interleaved rounds, and whether one is later than another."""

from collections.abc import Iterable, Mapping, Sequence
from itertools import product
from statistics import median
from typing import NamedTuple, Self

import numpy as np

from tangible_core.data import Spread
from tangible_core.servo import Ring
from tangible_core.servo.reports import spread
from tangible_core.servo.ring import MAX_LATE_S

from .figures import Figure

LATE_US = 200
# A loop is no later than another if its share of late ticks is at most so many times the other's, or points more.
TIMES, POINTS = 1.2, 0.1
HEADINGS = f"later than {LATE_US} us", "p50", "p99", "p99.9", "latest", "periods without a tick"
BY_CHANCE = 0.05  # what happens by chance in a larger share of cases is no difference


class Round(NamedTuple):
    """Ticks of one loop, for a few seconds."""

    late: np.ndarray  # ticks that began so many microseconds late; the last for all that were later
    overruns: int  # periods without a tick
    most_late_s: float

    @classmethod
    def of(cls, ring: Ring) -> Self:
        """Return the counts of the loop that wrote to this ring."""
        return cls(ring.late.copy(), ring.overruns, float(ring.sums[MAX_LATE_S]))

    @property
    def late_percent(self) -> float:
        """Of the ticks, those later than LATE_US."""
        return float(100 * self.late[LATE_US:].sum() / max(1, self.late.sum()))

    @property
    def late_us(self) -> Spread:
        """How late they were."""
        return spread(self.late, self.most_late_s)


def together(rounds: Iterable[Round]) -> Round:
    """All ticks of these rounds."""
    late, overruns, most = zip(*rounds, strict=True)
    return Round(np.sum(late, axis=0), sum(overruns), max(most))


def late_percent(rounds: Iterable[Round]) -> float:
    """Return the share of late ticks, the median of the rounds."""
    return median(each.late_percent for each in rounds)


def no_later_figure(what: str, mine: Sequence[Round], alone: Sequence[Round]) -> Figure:
    """Return the promise that a loop is no later than it is alone."""
    told = f"{late_percent(mine):.3f} %, alone {late_percent(alone):.3f} %"
    bound = f"<= {TIMES:g} x alone, or {POINTS:g} points more"
    return Figure(f"ticks later than {LATE_US} us, {what}", bound, told, no_later(mine, alone))


def no_later(mine: Sequence[Round], other: Sequence[Round]) -> bool:
    """Whether the share of late ticks, the median of the rounds, is TIMES the other's at most, or POINTS more."""
    one, two = late_percent(mine), late_percent(other)
    return one <= max(TIMES * two, two + POINTS)


def chance_of(more: Sequence[float], fewer: Sequence[float]) -> float:
    """How often chance alone lets the first ones, added up, exceed the others by as much as they do, or by more.

    The first of both are a pair, as are the second, and so on; all ways to exchange the two of a pair are counted. A
    standstill of the machine that one round met is chance, a few more in each round are not.

    >>> chance_of([2, 2, 2, 2], [1, 1, 1, 1]), chance_of([40, 0, 0, 0], [0, 1, 1, 1]), chance_of([1, 0], [1, 0])
    (0.0625, 0.5, 1.0)
    """
    differences = np.subtract(more, fewer)
    signs = np.array(list(product((1, -1), repeat=len(differences))))
    return float(np.mean(signs @ differences >= differences.sum()))


def no_more_overruns(mine: Sequence[Round], other: Sequence[Round]) -> bool:
    """Whether periods without a tick are no more than in the other's rounds, or so few more that chance explains it."""
    return chance_of([each.overruns for each in mine], [each.overruns for each in other]) > BY_CHANCE


def rows(kinds: Mapping[str, Sequence[Round]]) -> list[tuple[str, ...]]:
    """Return a line for each kind: share of late ticks as the median of its rounds; the rest of all ticks together."""
    return [_row(name, rounds) for name, rounds in kinds.items()]


def _row(name: str, rounds: Sequence[Round]) -> tuple[str, ...]:
    share, every = late_percent(rounds), together(rounds)
    late = every.late_us
    quantiles = (f"{us:.0f} us" for us in (late.p50, late.p99, late.p999, late.most))
    return name, f"{share:.3f} %", *quantiles, str(every.overruns)
