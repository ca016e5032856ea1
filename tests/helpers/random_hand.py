"""Millions of ticks of a hand and a device that do whatever they can: what a law did at its worst."""

from typing import Any, NamedTuple, cast

import numpy as np

from tangible_core.compiled.touch import CompiledTouch
from tangible_core.data import HapticSurface

MARGIN_M = 0.002
"""How far under the base plane and over the highest place the hand goes."""


class Worst(NamedTuple):
    """Of all ticks."""

    not_finite: int
    """Forces that were not finite."""
    pushed_when_broken: int
    """Forces other than zero for a state that was not finite."""
    greatest_n: float
    gained_j: float
    """The most that a tick gave: energy that a spring holds, |F|^2 / 2 k, over what it held and the hand put in.

    What sampling alone gives, k |step|^2 / 2, is taken off. Ticks after a leap or a broken state do not count.
    """
    lost: int
    """Ticks that were more than a micrometre off the ball, from 20 ticks after a leap on."""
    touched: int
    """Ticks in contact."""


def fuzz(
    touch: CompiledTouch,
    surface: HapticSurface,
    ticks: int,
    seed: int = 0,
    stiffness_n_per_m: float = 800.0,
    ball_m: tuple[float, float] = (0.0, 0.0),
) -> Worst:
    """What a touch did over a walk at up to 0.5 m/s, 0.05 mm/s at least, over the surface, its sides and its bottom.

    Once in 2000 ticks the hand is put down elsewhere, once in 1000 a number of the state is NaN or infinite, and the
    velocity is that of a clock that jitters fivefold. ball_m: radius and z of the centre of a ball that the surface is.
    Compiled on the first use of a law on a machine.
    """
    import random_hand_kernels

    found, half_m = np.zeros(6), np.array(surface.extent_m) / 2
    low_m, high_m = float(surface.height_m.min()) - MARGIN_M, float(surface.height_m.max()) + MARGIN_M
    cast(Any, random_hand_kernels).walk(
        touch.fixed, touch.address(), ticks, seed, half_m, low_m, high_m, stiffness_n_per_m, ball_m,
        np.zeros((5, 6)), found,
    )  # fmt: skip
    not_finite, pushed, greatest_n, gained_j, lost, touched = found.tolist()
    return Worst(int(not_finite), int(pushed), greatest_n, gained_j, int(lost), int(touched))
