"""How stiff a law is: its own word, or where it says nothing, what is felt of it before a device is opened."""

import logging
import math
import threading
from collections.abc import Iterator
from copy import deepcopy
from typing import NamedTuple

from ...data import DeviceSpec, Force, HapticState, Vector
from ...errors import BrokenMethod
from ...plugins.interfaces import Touch

log = logging.getLogger(__name__)
PLACES = 64
"""Where a law is felt, from the middle of the picture outwards."""
DEPTHS_M = (5e-5, 5e-4, 2e-3)
"""How far under the surface, as far as the force is one that the device can give."""
STEP_M = 2e-5
"""How far the hand goes on, twice, for a slope: less than it moves in a tick."""
LAYERS = 24
"""Heights at which a hand coming down looks for the surface, from the top of the workspace to just under its floor."""
HALVINGS = 10
"""Of the way between two of them, until the surface is found within some micrometres."""
MOST_S = 3.0
"""A law that takes longer than that is taken for what was felt of it until then. Most take a twentieth of it."""
GOLDEN = (0.7548776662466927, 0.5698402909980532)
"""1 / g and 1 / g^2, g^3 = g + 1: multiples of them fill a square evenly, and fall in step with no grid of cells.

Source: Roberts, The unreasonable effectiveness of quasirandom sequences, 2018.
"""


class Stiffness(NamedTuple):
    """Of a law."""

    n_per_m: float
    how: str
    """How it was found out; empty where the law says it."""


def stiffness_of(touch: Touch, spec: DeviceSpec) -> Stiffness:
    """What a law says of its stiffness, or what a copy of it is felt to have; takes MOST_S at most.

    A law that cannot be copied, or that raises, is taken for what was felt of it before: the loop will say its fault.
    Raises: BrokenMethod for a stiffness that is none.
    """
    said = touch.stiffness_n_per_m
    if said is None:
        return _measured(touch, spec)
    if not 0 <= said < math.inf:
        raise BrokenMethod(
            f"{type(touch).__name__} says a stiffness of {said} N/m; say 0 or more, or None to have it measured"
        )
    return Stiffness(float(said), "")


def _measured(touch: Touch, spec: DeviceSpec) -> Stiffness:
    steepest, trouble = 0.0, f"; it took longer than {MOST_S:g} s"

    def feel() -> None:
        nonlocal steepest, trouble
        try:
            for slope in slopes(deepcopy(touch), spec):
                steepest = max(steepest, slope)
        except BaseException as error:  # noqa: BLE001 - a law may even leave; in the loop that has an answer
            trouble = f"; then it raised {type(error).__name__}: {error}"
        else:
            trouble = ""

    feeling = threading.Thread(target=feel, daemon=True)  # a law that never answers must not hold the host
    feeling.start()
    feeling.join(MOST_S)
    how = f"{type(touch).__name__} does not say its stiffness, {steepest:.4g} N/m was felt{trouble}"
    log.log(logging.WARNING if trouble else logging.INFO, "%s", how)
    return Stiffness(steepest, how)


def slopes(touch: Touch, spec: DeviceSpec) -> Iterator[float]:
    """The steepest rise of the force for a way, N/m, at each place and depth where there is one.

    The touch is asked for at most PLACES (LAYERS + HALVINGS + 14 len(DEPTHS_M)) forces, all at rest and at time 0.
    """
    top_m = spec.workspace_m[2]
    for x, y in _places(spec):
        found = _surface(touch, x, y, top_m)
        if found is None:
            continue
        for depth_m in DEPTHS_M:
            _felt(touch, (x, y, top_m))  # lifted clear: no place remembers another
            force, steepest = _steepest(touch, (x, y, found - depth_m))
            if math.hypot(*force) > spec.max_force_n and depth_m > DEPTHS_M[0]:
                break  # the guard scales it down: it rises no more
            if math.isfinite(steepest):
                yield steepest


def _places(spec: DeviceSpec) -> Iterator[tuple[float, float]]:
    """Over as much of the picture as the device reaches, denser in the middle: a picture may be smaller."""
    for number in range(PLACES):
        across, along = (2 * ((0.5 + number * step) % 1) - 1 for step in GOLDEN)
        yield across * abs(across) * spec.workspace_m[0] / 2, along * abs(along) * spec.workspace_m[1] / 2


def _surface(touch: Touch, x: float, y: float, top_m: float) -> float | None:
    """The height at which a hand that comes down feels something first; None if it never does."""
    layer_m = top_m / (LAYERS - 2)
    free = top_m
    while not any(_felt(touch, (x, y, free))):
        free -= layer_m
        if free < -1.5 * layer_m:
            return None
    if free == top_m:
        return top_m
    pressed, free = free, free + layer_m
    for _ in range(HALVINGS):
        middle = (free + pressed) / 2
        free, pressed = (free, middle) if any(_felt(touch, (x, y, middle))) else (middle, pressed)
    return pressed


def _steepest(touch: Touch, place: Vector) -> tuple[Force, float]:
    """The force at a place, and the most by which it changes for a way along it, or across it in two directions.

    Of two steps the one with less counts: a force that jumps, as where one cell or material ends, is no spring. Nor is
    one that changes as much under a hand at rest, such as a vibration.
    """
    force = _felt(touch, place)
    strength = math.hypot(*force)
    if not 0 < strength < math.inf:
        return force, 0.0
    steepest = 0.0
    for way in _ways((-force.x / strength, -force.y / strength, -force.z / strength)):
        before, rest, one, two = (_felt(touch, _gone(place, way, steps * STEP_M)) for steps in (0, 0, 1, 2))
        moved = min(math.dist(rest, one), math.dist(one, two)) - math.dist(before, rest)
        steepest = max(steepest, moved / STEP_M)
    return force, steepest


def _ways(against: Vector) -> tuple[Vector, Vector, Vector]:
    """A direction, and two at right angles to it and to each other."""
    x, y, z = against
    flat = math.hypot(x, y)
    aside = (-y / flat, x / flat, 0.0) if flat > 1e-9 else (1.0, 0.0, 0.0)
    return against, aside, (y * aside[2] - z * aside[1], z * aside[0] - x * aside[2], x * aside[1] - y * aside[0])


def _gone(place: Vector, way: Vector, far_m: float) -> Vector:
    return place[0] + far_m * way[0], place[1] + far_m * way[1], place[2] + far_m * way[2]


def _felt(touch: Touch, place: Vector) -> Force:
    return Force(*map(float, touch.force(HapticState(place))))
