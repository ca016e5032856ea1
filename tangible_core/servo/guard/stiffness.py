"""The stiffness of a force law: stated by the law, or measured on a copy of it before a device is opened."""

import logging
import math
import threading
from collections.abc import Iterator
from copy import deepcopy
from typing import NamedTuple

from ...data import DeviceSpec, Force, HapticState, Vector
from ...errors import BrokenMethod
from ...plugins.interfaces import Touch

log: logging.Logger = logging.getLogger(__name__)
PLACES = 64  # number of places at which a force law is probed, from the middle of the picture outwards
# Depths of the probes under the surface; deeper ones are left out once the force exceeds the device's.
DEPTHS_M = (5e-5, 5e-4, 2e-3)
STEP_M = 2e-5  # step of a hand for a slope, made twice: less than a hand moves in a tick
LAYERS = 24
"""Number of heights at which the surface is searched, from the top of the workspace to just under its floor."""
# Number of bisections between two of these heights, until the surface is known within some micrometres.
HALVINGS = 10
# Longest time of a measurement; what was measured by then counts. Most force laws take a twentieth of it.
MAX_S = 3.0
GOLDEN = (0.7548776662466927, 0.5698402909980532)
"""1 / g and 1 / g^2 with g^3 = g + 1: their multiples fill a square evenly, in step with no grid of cells.

Source: Roberts, The unreasonable effectiveness of quasirandom sequences, 2018.
"""


class Stiffness(NamedTuple):
    """The stiffness of a force law."""

    n_per_m: float
    how: str  # a sentence about the measurement; empty if the law states its stiffness


def find_stiffness(touch: Touch, spec: DeviceSpec) -> Stiffness:
    """Return the stiffness that a force law states, or else measure that of a copy, in MAX_S at most.

    If the law cannot be copied, or raises, the slopes measured until then count; the loop will report the fault.
    Raises: BrokenMethod for a stiffness that is negative or not finite.
    """
    n_per_m = touch.stiffness_n_per_m
    if n_per_m is None:
        return _measure(touch, spec)
    if not 0 <= n_per_m < math.inf:
        raise BrokenMethod(
            f"{type(touch).__name__} states a stiffness of {n_per_m} N/m; state 0 or more, or None to have it measured"
        )
    return Stiffness(float(n_per_m), "")


def _measure(touch: Touch, spec: DeviceSpec) -> Stiffness:
    steepest, trouble = 0.0, f"; it took longer than {MAX_S:g} s"

    def probe() -> None:
        nonlocal steepest, trouble
        try:
            for slope in slopes(deepcopy(touch), spec):
                steepest = max(steepest, slope)
        except BaseException as error:  # noqa: BLE001 - a law may even raise SystemExit, which the loop will report
            trouble = f"; then it raised {type(error).__name__}: {error}"
        else:
            trouble = ""

    probing = threading.Thread(target=probe, daemon=True)  # a law that never answers must not block the host
    probing.start()
    probing.join(MAX_S)
    how = f"{type(touch).__name__} does not state its stiffness; {steepest:.4g} N/m was measured{trouble}"
    log.log(logging.WARNING if trouble else logging.INFO, "%s", how)
    return Stiffness(steepest, how)


def slopes(touch: Touch, spec: DeviceSpec) -> Iterator[float]:
    """Yield the steepest slope of the force, N/m, at each probed place and depth that has one."""
    top_m = spec.workspace_m[2]
    for x, y in _places(spec):
        height_m = _surface_height(touch, x, y, top_m)
        if height_m is None:
            continue
        for depth_m in DEPTHS_M:
            _force_at(touch, (x, y, top_m))  # lifted clear, so that contact at one place does not affect the next
            force, steepest = _steepest(touch, (x, y, height_m - depth_m))
            if math.hypot(*force) > spec.max_force_n and depth_m > DEPTHS_M[0]:
                break  # the guard clips such a force, so its slope is not felt
            if math.isfinite(steepest):
                yield steepest


def _places(spec: DeviceSpec) -> Iterator[tuple[float, float]]:
    """Yield the places (x, y), over the device's reach and denser in the middle, as a picture may be smaller."""
    for number in range(PLACES):
        across, along = (2 * ((0.5 + number * step) % 1) - 1 for step in GOLDEN)
        yield across * abs(across) * spec.workspace_m[0] / 2, along * abs(along) * spec.workspace_m[1] / 2


def _surface_height(touch: Touch, x: float, y: float, top_m: float) -> float | None:
    """Return the height at which a hand that comes down first feels a force; None if it never does."""
    layer_m = top_m / (LAYERS - 2)
    free = top_m
    while not any(_force_at(touch, (x, y, free))):
        free -= layer_m
        if free < -1.5 * layer_m:
            return None
    if free == top_m:
        return top_m
    contact, free = free, free + layer_m
    for _ in range(HALVINGS):
        middle = (free + contact) / 2
        free, contact = (free, middle) if any(_force_at(touch, (x, y, middle))) else (middle, contact)
    return contact


def _steepest(touch: Touch, place: Vector) -> tuple[Force, float]:
    """Return the force at a place, and its steepest slope along itself or in two directions across it.

    The lesser change of two steps counts: a force that jumps, as at the border of a cell or material, is not a spring.
    The change of the force on a hand at rest, such as by a vibration, is subtracted.
    """
    force = _force_at(touch, place)
    strength = math.hypot(*force)
    if not 0 < strength < math.inf:
        return force, 0.0
    steepest = 0.0
    for way in _ways((-force.x / strength, -force.y / strength, -force.z / strength)):
        before, rest, one, two = (_force_at(touch, _displace(place, way, steps * STEP_M)) for steps in (0, 0, 1, 2))
        change = min(math.dist(rest, one), math.dist(one, two)) - math.dist(before, rest)
        steepest = max(steepest, change / STEP_M)
    return force, steepest


def _ways(against: Vector) -> tuple[Vector, Vector, Vector]:
    """Return a direction, and two at right angles to it and to each other."""
    x, y, z = against
    flat = math.hypot(x, y)
    aside = (-y / flat, x / flat, 0.0) if flat > 1e-9 else (1.0, 0.0, 0.0)
    return against, aside, (y * aside[2] - z * aside[1], z * aside[0] - x * aside[2], x * aside[1] - y * aside[0])


def _displace(place: Vector, way: Vector, far_m: float) -> Vector:
    return place[0] + far_m * way[0], place[1] + far_m * way[1], place[2] + far_m * way[2]


def _force_at(touch: Touch, place: Vector) -> Force:
    return Force(*map(float, touch.force(HapticState(place))))
