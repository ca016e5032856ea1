"""What a tick of the proxy takes, by size of the surface."""

from collections.abc import Callable, Iterator
from time import thread_time

import numpy as np

from tangible_render.proxy import Proxy

from .figures import Figure
from .render_waves import HAND, TICKS, path, surface
from .turns import in_turns


def figures() -> Iterator[Figure]:
    """Yield the time of a tick of the proxy by size of the surface."""
    hands = path(HAND)
    touches = {f"{count}": Proxy().touch(surface(count)) for count in (64, 256, 1024, 4096)}
    times = in_turns({name: _twice(touch.path, hands) for name, touch in touches.items()}, 25, thread_time)
    ns = {name: 1e9 * time.seconds / TICKS / 2 for name, time in times.items()}
    told = ", ".join(f"{name}^2 {each:.0f}" for name, each in ns.items())
    yield Figure("`proxy` tick", "<= 400 ns", told, max(ns.values()) <= 400)
    ratio = max(time.ratio for time in times.values())
    yield Figure("the same, slowest over 64^2", "<= 1.3 x", f"{ratio:.2f} x", ratio <= 1.3)


def _twice(call: Callable[[np.ndarray], object], hands: np.ndarray) -> Callable[[], object]:
    return lambda: (call(hands), call(hands))
