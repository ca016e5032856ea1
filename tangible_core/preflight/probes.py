"""Probes of a touch all over its surface, by a hand that presses down; any force law works, as only forces are read."""

from dataclasses import dataclass
from typing import final

import numpy as np
from jaxtyping import Float64

from ..data import HapticSurface, Record
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
