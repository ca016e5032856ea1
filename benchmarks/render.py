"""Touch: every promise about the force laws with its bound, and what stands behind the figures."""

from collections.abc import Callable, Iterator
from time import thread_time

import numpy as np
from numba import njit

from tangible_core.data import HapticSurface
from tangible_core.interfaces import ForceRenderer
from tangible_core.registry import default_registry
from tangible_core.testing.rough import rough_surfaces
from tangible_render import mask_kernels
from tangible_render.grey_levels import grey_levels
from tangible_render.proxy import Proxy
from tangible_render.tangible_mask import TangibleMask, summed_tables

from .figures import Figure, judged, table
from .turns import in_turns

TICKS, DEPTH_M = 4000, 0.0008
AMPLITUDE_M, WAVE = 0.004, 2 * np.pi / 0.02
HAND, FAST = 1.0, 6.1
"""82 and 500 mm/s at most, over the ground."""


def section() -> str:
    """The section of RESULTS.md, as Markdown."""
    return "\n".join(
        [
            f"Waves of {2000 * AMPLITUDE_M:g} mm every 20 mm on 80 mm, a hand {1000 * DEPTH_M:g} mm under them, 1 kHz. "
            "ns a tick are those of `path`, compiled, with the velocity of each step, in processor time, in turns.",
            "",
            *judged([*_accuracy(), *_growth(), *_energy(), *_mask()]),
            "",
            "What is left out, in ns a tick and as a share of all of it.",
            "",
            *_skips(),
            "",
            "Every law on the same path over 256 x 256 cells.",
            "",
            *_laws(),
        ]
    )


def surface(count: int, steps: int = 0) -> HapticSurface:
    """Waves on count x count cells, as floats or in so many steps."""
    c = ((np.arange(count) + 0.5) / count - 0.5) * 0.08
    heights = AMPLITUDE_M * (1 + np.sin(WAVE * c)[None] * np.sin(-WAVE * c)[:, None])
    return HapticSurface.from_heights(np.rint(heights / 0.008 * steps) / steps * 0.008 if steps else heights)


def path(speed: float, depth_m: float = DEPTH_M) -> np.ndarray:
    """A wandering hand, this deep under the waves."""
    t = np.arange(TICKS) / 1000 * speed
    x, y = 0.034 * np.sin(2 * np.pi * 0.31 * t), 0.034 * np.sin(2 * np.pi * 0.23 * t + 0.7)
    return np.column_stack([x, y, AMPLITUDE_M * (1 + np.sin(WAVE * x) * np.sin(WAVE * y)) - depth_m])


def nearest(hands: np.ndarray) -> np.ndarray:
    """The exact nearest points, by Newton's method on the formula, followed along the path."""
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


def _growth() -> Iterator[Figure]:
    hands = path(HAND)
    touches = {f"{count}": Proxy().touch(surface(count)) for count in (64, 256, 1024, 4096)}
    times = in_turns({name: _twice(touch.path, hands) for name, touch in touches.items()}, 25, thread_time)
    ns = {name: 1e9 * each.seconds / TICKS / 2 for name, each in times.items()}
    told = ", ".join(f"{name}^2 {each:.0f}" for name, each in ns.items())
    yield Figure("`proxy` tick", "<= 400 ns", told, max(ns.values()) <= 400)
    ratio = max(each.ratio for each in times.values())
    yield Figure("the same, slowest over 64^2", "<= 1.15 x", f"{ratio:.2f} x", ratio <= 1.15)


def _twice(call: Callable[[np.ndarray], object], hands: np.ndarray) -> Callable[[], object]:
    return lambda: (call(hands), call(hands))


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


def _mask() -> Iterator[Figure]:
    side, hands = 65, path(0.3)
    map_ = surface(512)
    dark = 255 - grey_levels(map_.height_m)
    rows, columns = ((0.5 - hands[:, 1] / 0.08) * 512).astype(int), ((0.5 + hands[:, 0] / 0.08) * 512).astype(int)
    rows, columns = rows.clip(32, 479), columns.clip(32, 479)
    plain, quick = np.empty((2, TICKS, 2), np.int64)
    tables = summed_tables(dark)
    calls = {
        "tables": lambda: _by_tables(tables, rows, columns, side // 2, quick),
        "plain": lambda: _by_sums(dark, rows, columns, side // 2, plain),
        "tick": _twice(TangibleMask(mask_px=side).touch(map_).path, hands[: TICKS // 2]),
    }
    times = in_turns(calls, 15, thread_time)
    ratio = times["plain"].ratio
    told = f"{ratio:.0f} x; {times['plain'].seconds / times['tick'].seconds:.0f} x with all of the tick; "
    same = bool((plain == quick).all())
    yield Figure(
        "`tangible-mask` 65 x 65 against the plain sum", ">= 50 x, equal", told + f"equal: {same}", ratio >= 50 and same
    )


@njit(nogil=True)
def _by_sums(dark, rows, columns, half, out):  # noqa: ANN001, ANN202
    for i in range(rows.size):
        across, along = 0, 0
        for v in range(-half, half + 1):
            for u in range(-half, half + 1):
                value = np.int64(dark[rows[i] + v, columns[i] + u])
                across += value * u
                along -= value * v
        out[i, 0], out[i, 1] = across, along


@njit(nogil=True)
def _by_tables(tables, rows, columns, half, out):  # noqa: ANN001, ANN202
    for i in range(rows.size):
        out[i, 0], out[i, 1] = mask_kernels.window(tables, rows[i], columns[i], half, half)


def _skips() -> list[str]:
    level = HapticSurface.from_heights(np.full((256, 256), 0.004))
    flat = path(HAND)
    flat[:, 2] = 0.003
    over, high = path(HAND, -0.0005), path(HAND, -0.02)
    general = Proxy(damping_n_s_per_m=1e-300)  # too little to be felt, so that the law of all parts runs
    rows = [
        ("no friction, no damping, one material", Proxy(), general, surface(256), path(HAND)),
        ("a level tile", Proxy(), general, level, flat),
        ("free air, 0.5 mm over the surface", Proxy(), Proxy(), surface(256), over),
        ("free air, over all of a tile", Proxy(), Proxy(), surface(256), high),
    ]
    whole = Proxy().touch(surface(256))
    lines = []
    for what, quick, slow, felt, hands in rows:
        base = _twice(slow.touch(felt).path, hands) if slow != quick else _twice(whole.path, path(HAND))
        times = in_turns({"whole": base, "less": _twice(quick.touch(felt).path, hands)}, 15, thread_time)
        ns = [1e9 * times[name].seconds / TICKS / 2 for name in ("whole", "less")]
        lines.append((what, f"{ns[0]:.0f}", f"{ns[1]:.0f}", f"{times['less'].ratio:.2f}"))
    return table(("left out", "all of it, ns", "without, ns", "share"), lines)


def _laws() -> list[str]:
    felt, hands = surface(256), path(HAND)
    methods: dict[str, ForceRenderer] = {
        each.name: default_registry().load("render", each.name)()
        for each in default_registry().listings
        if each.kind == "render" and each.distribution == "tangible-images"
    }
    methods["proxy, friction 0.6 and 0.4"] = Proxy(static_friction=0.6, dynamic_friction=0.4)
    times = in_turns({name: _twice(each.touch(felt).path, hands) for name, each in methods.items()}, 15, thread_time)
    return table(
        ("law", "ns a tick"), [(name, f"{1e9 * each.seconds / TICKS / 2:.0f}") for name, each in times.items()]
    )
