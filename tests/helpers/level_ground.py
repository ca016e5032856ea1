"""Level ground, and what a simulated device reads and feels there."""

import numpy as np

from tangible_core.data import Force, HapticState, HapticSurface
from tangible_core.plugins.interfaces import Link, Touch
from tangible_devices.mock import Mock

GROUND_M = 1 / 128  # exact in float32
GROUND = HapticSurface.from_heights(np.full((8, 8), GROUND_M))


def read(link: Link, count: int) -> list[HapticState]:
    return [link.read() for _ in range(count)]


def positions(mock: Mock, count: int) -> np.ndarray:
    with mock.open() as link:
        return np.array([state.position_m for state in read(link, count)])


def feel(link: Link, touch: Touch, count: int) -> list[tuple[HapticState, Force]]:
    felt = []
    for _ in range(count):
        state = link.read()
        link.write(touch.force(state))
        felt.append((state, link.applied))
    return felt
