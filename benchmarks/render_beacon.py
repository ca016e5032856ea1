"""What a beacon takes of a tick, beside the guard that it goes through."""

from collections.abc import Iterator
from functools import partial
from time import thread_time

import numpy as np
from numba import njit

from tangible_core.compiled.kernels import step_velocity
from tangible_core.data import HapticSurface
from tangible_core.servo.beacon import BeaconMemory, beacon_to
from tangible_core.servo.beacon_kernels import pull
from tangible_core.servo.guard.guard import guard
from tangible_core.servo.guard.safety import Safety
from tangible_render.proxy import Proxy

from .figures import Figure
from .render_guard import DEVICE
from .render_waves import HAND, path, surface
from .turns import in_turns


def figures() -> Iterator[Figure]:
    """Law, beacon and guard against law and guard: while no beacon is on, and while one is."""
    waves, hands = surface(512), path(HAND)
    labels = np.zeros(waves.height_m.shape, np.int32)
    labels[100:140, 300:360] = 1
    beacon = beacon_to(HapticSurface(waves.relief, labels, None, ("ground", "part")), "part")
    touch = Proxy().touch(waves)
    law, forces = (touch.fixed, touch.address()), np.empty_like(hands)  # pyright: ignore[reportAttributeAccessIssue]
    calls = {}
    for name, asked in {"without": None, "off": BeaconMemory.of(None), "on": BeaconMemory.of(beacon)}.items():
        settings, memory = Safety().arrays(DEVICE, 800.0)
        arrays = (asked or BeaconMemory.ready()).arrays
        calls[name] = partial(_ticks, *law, settings, memory, *arrays, asked is not None, hands, forces)
    times = in_turns(calls, 25, thread_time)
    ns = {name: 1e9 * time.seconds / len(hands) for name, time in times.items()}
    for name, most in (("off", 1.15), ("on", 1.6)):
        ratio = ns[name] / ns["without"]
        told = f"{ratio:.2f} x, {ns[name] - ns['without']:.0f} ns more"
        yield Figure(f"a tick of `proxy` and guard, a beacon {name}", f"<= {most:g} x", told, ratio <= most)


@njit(nogil=True)
def _ticks(fixed, law, settings, memory, words, numbers, field, pulls, hands, forces):
    for i in range(hands.shape[0]):
        x, y, z = hands[i, 0], hands[i, 1], hands[i, 2]
        vx, vy, vz = step_velocity(hands, 0.001, i)
        fx, fy, fz = law(*fixed, x, y, z, vx, vy, vz)
        if pulls:
            pull(words, numbers, field, memory, 0.001, x, y, vx, vy, 0)
        forces[i, 0], forces[i, 1], forces[i, 2], _ = guard(settings, memory, 0.001, x, y, z, vx, vy, vz, fx, fy, fz)
