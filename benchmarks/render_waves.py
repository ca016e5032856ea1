"""Waves under a wandering hand, and the exact nearest points on them: how far off the proxy is."""

from collections.abc import Iterator

import numpy as np

from tangible_core.data import HapticSurface
from tangible_render.proxy import Proxy

from .figures import Figure
from .tests_path import rough_surfaces

TICKS, DEPTH_M = 4000, 0.0008
AMPLITUDE_M, WAVE = 0.004, 2 * np.pi / 0.02
HAND, FAST = 1.0, 6.1  # 82 and 500 mm/s at most, over the ground


def figures() -> Iterator[Figure]:
    """Accuracy of the proxy, and its energy."""
    yield from _accuracy()
    yield from _energy()


def surface(count: int, steps: int = 0) -> HapticSurface:
    """Waves on count x count cells, as floats or in so many steps."""
    c = ((np.arange(count) + 0.5) / count - 0.5) * 0.08
    heights = AMPLITUDE_M * (1 + np.sin(WAVE * c)[None] * np.sin(-WAVE * c)[:, None])
    return HapticSurface.from_heights(np.rint(heights / 0.008 * steps) / steps * 0.008 if steps else heights)


def path(speed: float, depth_m: float = DEPTH_M) -> np.ndarray:
    """Return a wandering hand, this deep under the waves."""
    t = np.arange(TICKS) / 1000 * speed
    x, y = 0.034 * np.sin(2 * np.pi * 0.31 * t), 0.034 * np.sin(2 * np.pi * 0.23 * t + 0.7)
    return np.column_stack([x, y, AMPLITUDE_M * (1 + np.sin(WAVE * x) * np.sin(WAVE * y)) - depth_m])


def nearest(hands: np.ndarray) -> np.ndarray:
    """Return the exact nearest points, by Newton's method on the formula, followed along the path."""
    found, p = np.empty_like(hands), hands[0, :2]
    for hand, out in zip(hands, found, strict=True):
        for _ in range(60):
            (sx, sy), (cx, cy) = np.sin(WAVE * p), np.cos(WAVE * p)
            height = AMPLITUDE_M * (1 + sx * sy)
            slope = AMPLITUDE_M * WAVE * np.array([cx * sy, sx * cy])
            bend = AMPLITUDE_M * WAVE**2 * np.array([[-sx * sy, cx * cy], [cx * cy, -sx * sy]])
            away = hand - [*p, height]
            step = np.linalg.solve(np.eye(2) + np.outer(slope, slope) - away[2] * bend, away[:2] + away[2] * slope)
            p = p + step
            if np.abs(step).max() < 1e-14:
                break
        out[:] = *p, AMPLITUDE_M * (1 + np.prod(np.sin(WAVE * p)))
    return found


def _accuracy() -> Iterator[Figure]:
    slow, fast = path(HAND), path(FAST)
    exact, exact_fast = nearest(slow), nearest(fast)
    for count in (256, 1024):
        force = Proxy(stiffness_n_per_m=1.0).touch(surface(count)).path(slow)
        off_um = 1e6 * np.percentile(np.linalg.norm(force + slow - exact, axis=1), 99)
        off_deg = np.percentile(_degrees(force, exact - slow), 99)
        bound = "<= 0.01 um and 0.001 degree p99"
        met = bool(off_um <= 0.01 and off_deg <= 0.001)
        yield Figure(f"`proxy` at 82 mm/s, {count}^2", bound, f"{off_um:.4f} um, {off_deg:.5f} degree", met)
        stepped = _degrees(Proxy().touch(surface(count, 255)).path(slow), exact - slow)
        worst = float(np.percentile(stepped, 99))
        yield Figure(f"the same in 8 bits, {count}^2", "<= 0.5 degree p99", f"{worst:.2f} degree", worst <= 0.5)
    off_um = 1e6 * np.linalg.norm(
        Proxy(stiffness_n_per_m=1.0).touch(surface(1024)).path(fast) + fast - exact_fast, axis=1
    )
    lost = int((off_um > 1).sum())
    yield Figure(
        "track at 500 mm/s, 1024^2", "no tick over 1 um off", f"{lost}; the worst {off_um.max():.3f} um", not lost
    )


def _degrees(force: np.ndarray, exact: np.ndarray) -> np.ndarray:
    sines = np.linalg.norm(np.cross(force, exact), axis=1) / np.linalg.norm(force, axis=1)
    return np.degrees(np.arcsin(np.minimum(1, sines / np.linalg.norm(exact, axis=1))))


def _energy() -> Iterator[Figure]:
    turn = np.arange(20000) / 20000
    x, y = 0.032 * np.sin(2 * np.pi * 5 * turn), 0.041 * np.sin(2 * np.pi * 3 * turn + 0.4)
    work = {}
    for name, rough in rough_surfaces(256).items():
        for depth in (0.0, 0.004):
            loop = np.column_stack([x, y, 0.002 + 0.001 * np.sin(2 * np.pi * 7 * turn) - depth])
            force = Proxy().touch(rough).path(np.vstack([loop, loop, loop[:1]]))[20000:]
            steps = np.diff(np.vstack([loop, loop[:1]]), axis=0)
            work[f"{name}, {1000 * depth:g} mm deeper"] = float(((force[1:] + force[:-1]) / 2 * steps).sum())
    worst = max(work, key=lambda name: work[name])
    told = f"most {1e3 * work[worst]:+.4f} mJ ({worst})"
    yield Figure(f"work of closed frictionless loops on {len(work)} stress maps", "<= 0 J", told, work[worst] <= 0)
