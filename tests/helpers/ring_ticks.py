"""Ticks for the tests of a ring."""

import numpy as np

from tangible_core.data import TICK_COLUMNS
from tangible_core.servo import Ring
from tangible_core.servo.ticks import cycle
from tangible_core.servo.ticks.loop import sections


def put(into: Ring, *numbers: int) -> None:
    """Write ticks whose values are all the number of the tick, without flags."""
    for number in numbers:
        row = np.full(len(TICK_COLUMNS), float(number))
        row[cycle.FLAGS] = 0
        cycle.finish(sections(into), row, number * 1_000_000, 2000 * number)
