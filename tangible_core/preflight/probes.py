"""A touch felt all over, by a hand that presses down as a hand does: whatever the law, it is only asked for forces."""

from dataclasses import dataclass
from typing import final

import numpy as np
from jaxtyping import Float64

from ..data import HapticSurface, Record
from ..plugins.interfaces import Touch
from ..scene.geometry import picture_to_workspace

PLACES = 64
"""A side of the grid; a surface of fewer cells is probed at each of them."""
SKIN_M = 1e-6
"""As deep as a hand that has only just come in."""
STEP_M = 1e-4
"""How much farther it goes in to find the stiffness: about what a hand moves in a tick."""
SLOW_STEP_M = 2e-5
"""And to find the damping: so little in a tick that the waves of a fine texture, which fade with speed, are whole."""
SOFT_M = 1e-3
"""How deep a hand is taken to press where a law is no spring and does not hold it up."""
CLEAR_M = 0.02
"""Between two places the hand is so far above the highest point."""
RESTS = 8
"""Ticks at rest, in which a proxy settles."""
ROUNDS = 3
"""Depths tried until the force is what the hand presses with; one is enough where force grows with depth in line."""

Points = Float64[np.ndarray, "n 3"]
Each = Float64[np.ndarray, " n"]


@dataclass(frozen=True, eq=False)
class Probes(Record):
    """What was felt at each place."""

    depth_m: Each
    """How far straight under the surface the hand came to rest."""
    force_n: Points
    """What it then felt."""
    onset_n: Each
    """Magnitude of the force a micrometre under the surface: how much it steps on contact."""
    stiffness_n_per_m: Each
    """By how much the force grows, along itself, for a metre farther against it."""
    damping_n_s_per_m: Each
    """And for a metre per second."""

    @property
    def strength_n(self) -> Each:
        """Magnitude of the force."""
        return np.linalg.norm(self.force_n, axis=1)


def probe(
    touch: Touch, surface: HapticSurface, press_n: float, stiffness_n_per_m: float, reach_m: float, period_s: float
) -> Probes:
    """Press down on a grid of places with press_n, no deeper than reach_m under the surface.

    Sideways the hand is held, so that a slope's force is whole: as strong as it gets for this press. A law that does
    not hold the hand up (one for a device on a table) is felt at the depth at which its spring would.
    """
    feeler = _Feeler(touch, float(surface.height_m.max()) + CLEAR_M, period_s)
    places = _places(surface)
    down = np.array([0.0, 0.0, -1.0])
    first = min(press_n / stiffness_n_per_m if stiffness_n_per_m > 0 else SOFT_M, reach_m)
    depth_m = np.full(len(places), first)
    for _ in range(ROUNDS):
        lift_n = feeler.rest(places + depth_m[:, None] * down)[:, 2]
        deeper = np.divide(press_n, lift_n, out=np.ones_like(lift_n), where=lift_n > 0)
        depth_m = np.clip(depth_m * deeper, SKIN_M, reach_m)
    pressed = places + depth_m[:, None] * down
    force_n, _, along = feeler.push(pressed, np.zeros_like(pressed))
    strength_n = np.linalg.norm(force_n, axis=1, keepdims=True)
    along = np.divide(force_n, strength_n, out=np.zeros_like(force_n), where=strength_n > 0)
    rest_n, _, later_n = feeler.push(pressed, -STEP_M * along)
    _, arrived_n, stopped_n = feeler.push(pressed, -SLOW_STEP_M * along)
    return Probes(
        depth_m=depth_m,
        force_n=force_n,
        onset_n=np.linalg.norm(feeler.rest(places + SKIN_M * down), axis=1),
        stiffness_n_per_m=np.sum((later_n - rest_n) * along, axis=1) / STEP_M,
        damping_n_s_per_m=np.sum((arrived_n - stopped_n) * along, axis=1) * period_s / SLOW_STEP_M,
    )


@final
class _Feeler:
    """A hand that is lifted clear of the surface before every place, so that no place remembers another."""

    def __init__(self, touch: Touch, clear_m: float, period_s: float) -> None:
        self._touch, self._clear_m, self._period_s = touch, clear_m, period_s

    def rest(self, places: Points) -> Points:
        """The force at each place, the hand at rest."""
        return self._stop(places)[:, 0, -1]

    def push(self, places: Points, step_m: Points) -> tuple[Points, Points, Points]:
        """The force at rest at each place; a step farther in the tick after; and there, at rest."""
        forces = self._stop(places, places + step_m)
        return forces[:, 0, -1], forces[:, 1, 0], forces[:, 1, -1]

    def _stop(self, *stops: Points) -> Float64[np.ndarray, "n stops ticks 3"]:
        """Forces at each stop, tick by tick, from the arrival on."""
        lifted = stops[0].copy()
        lifted[:, 2] = self._clear_m
        ticks = 1 + RESTS
        way = np.stack([lifted, *(stop for stop in stops for _ in range(ticks))], axis=1)
        forces = self._touch.path(np.ascontiguousarray(way.reshape(-1, 3)), self._period_s)
        return forces.reshape(way.shape)[:, 1:].reshape(len(lifted), len(stops), ticks, 3)


def _places(surface: HapticSurface) -> Points:
    """Centres of cells, evenly spread, on the surface."""
    rows, columns = (_spread(count) for count in surface.height_m.shape)
    row, column = (each.ravel() for each in np.meshgrid(rows, columns, indexing="ij"))
    x, y = picture_to_workspace(column, row, surface.height_m.shape, surface.extent_m)
    return np.column_stack([x, y, surface.height_m[row, column]]).astype(np.float64)


def _spread(count: int) -> np.ndarray:
    """At most PLACES whole numbers under count, symmetric: the middles of so many equal parts."""
    parts = min(count, PLACES)
    return ((np.arange(parts) + 0.5) * count / parts).astype(np.int64)
