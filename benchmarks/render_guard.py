"""The guard of a tick: the greatest step of a force, and what the guard takes."""

from collections.abc import Callable, Iterator
from functools import partial
from time import thread_time

import numpy as np
from numba import njit

from tangible_core.compiled.kernels import step_velocity
from tangible_core.data import DeviceSpec
from tangible_core.servo.guard.coupling import couple
from tangible_core.servo.guard.guard import guard
from tangible_core.servo.guard.safety import Safety
from tangible_render.proxy import Proxy

from .figures import Figure
from .render_waves import FAST, HAND, path, surface
from .tests_path import rough_surfaces
from .turns import in_turns

DEVICE = DeviceSpec(8.0, 3000.0, 1.5, (0.08, 0.08, 0.08), 3e-5)


def figures() -> Iterator[Figure]:
    """Yield the steps of a force, and the time of a tick."""
    yield _steps()
    ns = _times({"guard": (Safety(), 800.0)})["guard"]
    yield Figure("the guard, as it is without options", "<= 60 ns", f"{ns:.0f} ns", ns <= 60)


def _steps() -> Figure:
    worst, raw = 0.0, 0.0
    for rough in rough_surfaces(256).values():
        hands = path(FAST)
        law = Proxy().touch(rough).path(hands)
        settings, memory = Safety().arrays(DEVICE, 800.0)
        left = np.empty_like(law)
        _guarded(settings, memory, hands, law, left)
        raw, worst = (max(most, _step(force)) for most, force in ((raw, law), (worst, left)))
    told = f"{worst:.3f} N; {raw:.1f} N without"
    return Figure(
        "greatest step of the force in a tick, all stress maps, 500 mm/s", "<= 0.5 N", told, worst <= 0.5 + 1e-9
    )


def _step(force: np.ndarray) -> float:
    return float(np.linalg.norm(np.diff(force, axis=0), axis=1).max())


@njit(nogil=True)
def _guarded(settings, memory, hands, law, left):
    for i in range(hands.shape[0]):
        x, y, z = hands[i, 0], hands[i, 1], hands[i, 2]
        vx, vy, vz = step_velocity(hands, 0.001, i)
        _, _, pressed, _, _, _ = couple(settings, memory, 0.001, x, y, z, vx, vy, vz)
        left[i, 0], left[i, 1], left[i, 2], _ = guard(
            settings, memory, 0.001, x, y, z, vx, vy, vz, law[i, 0], law[i, 1], law[i, 2] + 0.0 * pressed
        )


@njit(nogil=True)
def _unguarded(hands, law, left):
    for i in range(hands.shape[0]):
        vx, vy, vz = step_velocity(hands, 0.001, i)
        left[i, 0], left[i, 1], left[i, 2] = law[i, 0] - vx, law[i, 1] - vy, law[i, 2] - vz


def _times(chosen: dict[str, tuple[Safety, float]]) -> dict[str, float]:
    """ns a tick of each guard, for a law of a stiffness, the loop around it left out."""
    hands = np.vstack([path(HAND)] * 5)
    law = Proxy().touch(surface(256)).path(hands)
    left = np.empty_like(law)
    calls: dict[str, Callable[[], object]] = {"loop": lambda: _unguarded(hands, law, left)}
    for name, (safety, stiffness) in chosen.items():
        settings, memory = safety.arrays(DEVICE, stiffness)
        calls[name] = partial(_guarded, settings, memory, hands, law, left)
    times = in_turns(calls, 25, thread_time)
    return {name: 1e9 * (times[name].seconds - times["loop"].seconds) / len(hands) for name in chosen}
