"""Probes of a touch all over its surface, and strokes, by a soft hand that presses down; any force law works."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import final

import numpy as np
from jaxtyping import Bool, Float64

from ..data import HapticState, HapticSurface, Record
from ..plugins.interfaces import Touch
from ..scene.geometry import picture_to_workspace

PLACES = 64
SKIN_M = 1e-6
# Further depth at which the stiffness is measured: about the movement of a hand in a tick.
STEP_M = 1e-4
# Step at which the damping is measured: so short that waves of a fine texture, which fade with speed, do not fade.
SLOW_STEP_M = 2e-5
# Depth of the hand under a force law that is not a spring and does not hold the hand up.
SOFT_M = 1e-3
CLEAR_M = 0.02
RESTS = 8  # ticks at rest, in which a proxy settles
# Depths tried until the force equals the press; one is enough if force is proportional to depth.
ROUNDS = 3

Points = Float64[np.ndarray, "n 3"]
Each = Float64[np.ndarray, " n"]
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
ABOVE_M = 0.003
# Ticks at the start of a stroke in which the hand comes down; they do not count.
APPROACH = 150
MARGIN = 0.04


@dataclass(frozen=True, eq=False)
class Probes(Record):
    """Measurements at each place."""

    depth_m: Each
    """Depth straight under the surface at which the hand came to rest."""
    force_n: Points
    onset_n: Each
    """Magnitude of the force a micrometre under the surface: its step on contact."""
    stiffness_n_per_m: Each
    """Growth of the force, along itself, with the distance moved against it."""
    damping_n_s_per_m: Each
    """Growth of the force, along itself, with the speed against it."""

    @property
    def strength_n(self) -> Each:
        """Magnitude of the force."""
        return np.linalg.norm(self.force_n, axis=1)


def probe(
    touch: Touch, surface: HapticSurface, press_n: float, stiffness_n_per_m: float, reach_m: float, period_s: float
) -> Probes:
    """Press down on a grid of places with press_n, no deeper than reach_m under the surface."""
    feeler = _Feeler(touch, float(surface.height_m.max()) + CLEAR_M, period_s)
    places = _places(surface)
    down = np.array([0.0, 0.0, -1.0])
    first = min(press_n / stiffness_n_per_m if stiffness_n_per_m > 0 else SOFT_M, reach_m)
    depth_m = np.full(len(places), first)
    # The hand is held sideways, so that the force of a slope is the strongest for this press. A force law that does not
    # hold the hand up (for a device on a table) is probed at the depth at which its spring would.
    for _ in range(ROUNDS):
        lift_n = feeler.rest(places + depth_m[:, None] * down)[:, 2]
        deeper = np.divide(press_n, lift_n, out=np.ones_like(lift_n), where=lift_n > 0)
        depth_m = np.clip(depth_m * deeper, SKIN_M, reach_m)
    rest_m = places + depth_m[:, None] * down
    force_n, _, along = feeler.push(rest_m, np.zeros_like(rest_m))
    strength_n = np.linalg.norm(force_n, axis=1, keepdims=True)
    along = np.divide(force_n, strength_n, out=np.zeros_like(force_n), where=strength_n > 0)
    rest_n, _, later_n = feeler.push(rest_m, -STEP_M * along)
    _, arrived_n, stopped_n = feeler.push(rest_m, -SLOW_STEP_M * along)
    return Probes(
        depth_m=depth_m,
        force_n=force_n,
        onset_n=np.linalg.norm(feeler.rest(places + SKIN_M * down), axis=1),
        stiffness_n_per_m=np.sum((later_n - rest_n) * along, axis=1) / STEP_M,
        damping_n_s_per_m=np.sum((arrived_n - stopped_n) * along, axis=1) * period_s / SLOW_STEP_M,
    )


@final
class _Feeler:
    """A hand that is lifted clear of the surface before every place, so that places do not affect each other."""

    def __init__(self, touch: Touch, clear_m: float, period_s: float) -> None:
        self._touch, self._clear_m, self._period_s = touch, clear_m, period_s

    def rest(self, places: Points) -> Points:
        """Return the force at each place, the hand at rest."""
        return self._stop(places)[:, 0, -1]

    def push(self, places: Points, step_m: Points) -> tuple[Points, Points, Points]:
        """Return the force at rest at each place, a step farther in the next tick, and there at rest."""
        forces = self._stop(places, places + step_m)
        return forces[:, 0, -1], forces[:, 1, 0], forces[:, 1, -1]

    def _stop(self, *stops: Points) -> Float64[np.ndarray, "n stops ticks 3"]:
        above = stops[0].copy()
        above[:, 2] = self._clear_m
        ticks = 1 + RESTS
        way = np.stack([above, *(stop for stop in stops for _ in range(ticks))], axis=1)
        forces = self._touch.path(np.ascontiguousarray(way.reshape(-1, 3)), self._period_s)
        return forces.reshape(way.shape)[:, 1:].reshape(len(above), len(stops), ticks, 3)


def _places(surface: HapticSurface) -> Points:
    rows, columns = (_spread(count) for count in surface.height_m.shape)
    row, column = (grid.ravel() for grid in np.meshgrid(rows, columns, indexing="ij"))
    x, y = picture_to_workspace(column, row, surface.height_m.shape, surface.extent_m)
    return np.column_stack([x, y, surface.height_m[row, column]]).astype(np.float64)


def _spread(count: int) -> np.ndarray:
    """Return at most PLACES indices below count, symmetric: the middles of equal parts."""
    parts = min(count, PLACES)
    return ((np.arange(parts) + 0.5) * count / parts).astype(np.int64)


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
    position = [*way[0].tolist(), float(surface.height_m.max()) + ABOVE_M]
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
