"""Strokes of a soft hand over a surface: what a force law does to a hand that moves, whatever its formula is."""

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float64

from ..data import HapticState, HapticSurface, Record
from ..plugins.interfaces import Touch

LINES = 6
# The most ticks of a stroke; a stroke over a wider surface is shorter than the surface, about its middle.
MAX_TICKS = 1000
# The hand: that of the simulated devices, of the order of a relaxed hand that holds a handle.
MASS_KG, SPRING_N_PER_M, DAMPING_N_S_PER_M = 0.1, 300.0, 6.0
# The most that a hand pushes sideways, of its press: with more, it lifts off instead.
SIDEWAYS = 2.0
# The time in which a hand that is held up eases its press to nothing; in as much again it lifts as strongly.
EASES_S = 0.1
# Depth of the target under the lowest point of the surface, so that the hand presses everywhere.
REACH_DOWN_M = 0.02
CLEAR_M = 0.003
# Ticks at the start of a stroke in which the hand comes down; they do not count.
APPROACH = 150
MARGIN = 0.04


@dataclass(frozen=True, eq=False)
class Strokes(Record):
    """Measurements at each tick of all strokes."""

    force_n: Float64[np.ndarray, "n"]
    rise_n: Float64[np.ndarray, "n"]
    """Growth of that magnitude since the tick before; negative where it falls."""
    held_up: Bool[np.ndarray, "n"]
    """True where the hand pushes sideways as strongly as it can, and the surface does not give way."""


def stroke(touch: Touch, surface: HapticSurface, press_n: float, speed_m_per_s: float, period_s: float) -> Strokes:
    """Stroke a surface to and fro along LINES columns and rows, with a hand on a spring that presses down."""
    ways = _ways(surface, speed_m_per_s * period_s)
    strokes = [list(_stroke_once(touch, surface, way, press_n, period_s)) for way in ways]
    force_n, held_up = (np.concatenate([[tick[k] for tick in ticks] for ticks in strokes]) for k in (0, 1))
    rise_n = np.concatenate([np.diff([tick[0] for tick in ticks], prepend=ticks[0][0]) for ticks in strokes])
    return Strokes(force_n.astype(np.float64), rise_n, held_up.astype(bool))


def _ways(surface: HapticSurface, step_m: float) -> list[Float64[np.ndarray, "n 2"]]:
    ways: list[np.ndarray] = []
    for axis in (0, 1):
        length_m, across_m = surface.extent_m[axis], surface.extent_m[1 - axis]
        ticks = min(MAX_TICKS, max(2, math.ceil((1 - 2 * MARGIN) * length_m / step_m)))
        along = (np.arange(ticks) - (ticks - 1) / 2) * min(step_m, (1 - 2 * MARGIN) * length_m / ticks)
        for line in range(LINES):
            way = np.empty((ticks, 2))
            way[:, axis] = along if line % 2 == 0 else -along
            way[:, 1 - axis] = ((line + 0.5) / LINES - 0.5) * across_m
            ways.append(way)
    return ways


def _stroke_once(
    touch: Touch, surface: HapticSurface, way: Float64[np.ndarray, "n 2"], press_n: float, period_s: float
) -> Iterator[tuple[float, bool]]:
    """Yield the magnitude of the force at each tick of a stroke, and whether the hand is held up."""
    down_m = float(surface.height_m.min()) - REACH_DOWN_M
    position = [*way[0].tolist(), float(surface.height_m.max()) + CLEAR_M]
    velocity = [0.0, 0.0, 0.0]
    most_n, now_n = SIDEWAYS * press_n, press_n
    # The hand gives way, as a real one does: it presses with `press_n` at most, and pushes sideways with SIDEWAYS times
    # as much at most. Its velocity is integrated before its position, which is stable at 500 Hz and more.
    for number, target in enumerate([way[0].tolist()] * APPROACH + way.tolist()):
        x, y, z = position
        force = touch.force(HapticState((x, y, z), (velocity[0], velocity[1], velocity[2]), number * period_s))
        along, across = (SPRING_N_PER_M * (target[axis] - position[axis]) for axis in (0, 1))
        sideways_n = math.hypot(along, across)
        share = min(1.0, most_n / max(sideways_n, 1e-9))
        held_up = sideways_n >= most_n
        change_n = period_s / EASES_S * press_n
        now_n = max(now_n - change_n, -press_n) if held_up else min(now_n + change_n, press_n)
        push = (along * share, across * share, max(SPRING_N_PER_M * (down_m - z), -now_n))
        for axis in range(3):
            pull = push[axis] + force[axis] - DAMPING_N_S_PER_M * velocity[axis]
            velocity[axis] += period_s * pull / MASS_KG
            position[axis] += period_s * velocity[axis]
        if number >= APPROACH:
            yield math.hypot(*force), held_up
