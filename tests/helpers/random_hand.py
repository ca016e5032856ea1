"""Millions of ticks of a random hand and a failing device, and the worst responses of a force law."""

from typing import Any, NamedTuple, cast

import numpy as np

from tangible_core.compiled.touch import CompiledTouch
from tangible_core.data import HapticSurface

MARGIN_M = 0.002
"""Distance to which the hand goes under the base plane and over the highest place."""


class Worst(NamedTuple):
    """The worst responses of all ticks."""

    not_finite: int
    """Number of forces that were not finite."""
    pushed_when_broken: int
    """Number of forces other than zero for a state that was not finite."""
    greatest_n: float
    gained_j: float
    """Largest energy gained in a tick: that of a spring, |F|^2 / 2 k, minus its previous one and the hand's work.

    The gain of sampling alone, k |step|^2 / 2, is subtracted. Ticks after a leap or a broken state do not count.
    """
    lost: int
    """Number of ticks more than a micrometre off the ball, from 20 ticks after a leap on."""
    touched: int
    """Number of ticks in contact."""


def fuzz(
    touch: CompiledTouch,
    surface: HapticSurface,
    ticks: int,
    seed: int = 0,
    stiffness_n_per_m: float = 800.0,
    ball_m: tuple[float, float] = (0.0, 0.0),
) -> Worst:
    """Move a random hand at 0.05 mm/s to 0.5 m/s over a surface, its sides and bottom; return the worst responses."""
    import random_hand_kernels

    worst, half_m = np.zeros(6), np.array(surface.extent_m) / 2
    low_m, high_m = float(surface.height_m.min()) - MARGIN_M, float(surface.height_m.max()) + MARGIN_M
    cast(Any, random_hand_kernels).walk(
        touch.fixed, touch.address(), ticks, seed, half_m, low_m, high_m, stiffness_n_per_m, ball_m,
        np.zeros((5, 6)), worst,
    )  # fmt: skip
    not_finite, pushed, greatest_n, gained_j, lost, touched = worst.tolist()
    return Worst(int(not_finite), int(pushed), greatest_n, gained_j, int(lost), int(touched))
