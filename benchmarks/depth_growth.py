"""Time and memory as pictures grow, and what is seen of the strips they are swept in."""

from collections.abc import Generator, Mapping
from contextlib import contextmanager
from functools import partial
from typing import Literal

import numpy as np

from tangible_bench.memory import start_peak
from tangible_depth.matching.adaptive import PROBE_ROWS
from tangible_depth.semi_global import SemiGlobal
from tangible_depth.sgm import strips

from .depth_opencv import filled
from .depth_pairs import KnownScene, real
from .figures import Figure, table
from .turns import Call, seconds

DISPARITIES = 128
TILES = (1, 2, 3, 5, 7)
"""The builtin pair this often side by side and below itself: 0.4 to 18 megapixels, all with the same disparities."""
VOLUMES_BYTES = strips.VOLUME_BYTES
Effort = Literal["balanced", "best"]
MEMORY_BYTES_PX: Mapping[Effort, int] = {"balanced": 25, "best": 32}
"""What `semi-global` states, as VOLUMES_BYTES."""
OF: Mapping[Effort, str] = {"balanced": "", "best": ", `effort: best`"}
Size = tuple[float, float, float, float]
ROUNDS = 5
USUAL_COST: Literal["levels"] = "levels"
"""The cost that clean pairs are matched at."""
NEAR_ROWS = 8
"""Rows to either side of a border."""


def measured() -> tuple[list[Figure], list[str]]:
    """Return the promises about growth, and a row a size, of the default."""
    default = _sizes("balanced")
    figures = [*_promises("balanced", default), *_promises("best", _sizes("best")), _seams()]
    lines = [(f"{mpx:.1f}", f"{cost:.2f}", f"{used / 2**20:.0f}", f"{share:.2f}") for mpx, cost, used, share in default]
    return figures, table(("Mpx", "ns / px / disparity", "peak MiB", "time / 3WAY"), lines)


def _promises(effort: Effort, rows: list[Size]) -> list[Figure]:
    costs = [cost for _, cost, _, _ in rows]
    times = Figure(
        f"cost as work grows{OF[effort]}, {rows[0][0]:.1f} to {rows[-1][0]:.0f} Mpx, {DISPARITIES} disparities",
        "time per pixel and disparity within 1.5 x of its best",
        f"least of {ROUNDS} rounds: {min(costs):.2f} to {max(costs):.2f} ns: {max(costs) / min(costs):.2f} x",
        max(costs) <= 1.5 * min(costs),
    )
    pixels = [each[0] * 1e6 for each in rows]
    memory = [each[2] for each in rows]
    bounds = [MEMORY_BYTES_PX[effort] * count + VOLUMES_BYTES for count in pixels]
    slope = np.polyfit(pixels[1:], memory[1:], 1)[0]
    peak = Figure(
        f"memory above the pictures{OF[effort]}",
        f"bounded and stated: {MEMORY_BYTES_PX[effort]} bytes a pixel + {VOLUMES_BYTES >> 20} MiB",
        f"{memory[-1] / 2**20:.0f} MiB at {rows[-1][0]:.0f} Mpx, stated {bounds[-1] / 2**20:.0f}; "
        f"grows by {slope:.0f} bytes a pixel",
        all(used <= bound for used, bound in zip(memory, bounds, strict=True)),
    )
    return [times, peak]


def _sizes(effort: Effort) -> list[Size]:
    """Megapixels, nanoseconds a pixel and disparity, peak bytes, and time over 3WAY's, for each of TILES.

    The time is the least of the rounds: what else the machine does can only add, and hits short calls by chance.
    """
    scenes = [_tiled(count) for count in TILES]
    method = SemiGlobal(max_disparity_px=DISPARITIES, effort=effort)
    calls = [partial(method.estimate, each.views) for each in scenes]
    memory = [_peak(call) for call in calls]
    times = [
        [(seconds(partial(filled, each)), seconds(call)) for each, call in zip(scenes, calls, strict=True)]
        for _ in range(ROUNDS)
    ]
    found = []
    for i, scene in enumerate(scenes):
        pixels = scene.grey.left.size
        theirs, ours = np.array([each[i] for each in times]).T
        found.append((pixels / 1e6, 1e9 * min(ours) / pixels / DISPARITIES, memory[i], float(np.median(ours / theirs))))
    return found


def _peak(call: Call) -> float:
    call()
    growth = start_peak()
    call()
    return growth() or 0


def _tiled(count: int) -> KnownScene:
    scene = real()["motorcycle"]
    grey = scene.grey._replace(
        left=np.tile(scene.grey.left, (count, count)), right=np.tile(scene.grey.right, (count, count))
    )
    return KnownScene(scene.pair, grey, DISPARITIES)


def _seams() -> Figure:
    scenes = {**real(), "motorcycle x 4": _tiled(2)}
    shares = {f"{name}, {effort}": _seam(each, effort) for name, each in scenes.items() for effort in OF}
    worst = max(shares, key=shares.__getitem__)
    return Figure(
        f"seams: rows within {NEAR_ROWS} of a border, against one strip, {len(scenes)} scenes, either effort",
        "difference over 1 px at <= 0.5 % of the pixels",
        f"{shares[worst]:.2f} % at most ({worst}), {np.mean(list(shares.values())):.2f} % mean",
        shares[worst] <= 0.5,
    )


def _seam(scene: KnownScene, effort: Effort) -> float:
    """Percent of the pixels near borders, those of the trial among them, that one strip decides otherwise."""
    method = SemiGlobal(max_disparity_px=scene.disparities, cost=USUAL_COST, effort=effort)
    with_borders = method.estimate(scene.views).disparity_px
    with _one_strip():
        without = method.model_copy(update={"realign_rows": False}).estimate(scene.views).disparity_px
    h = len(without)
    borders = np.arange(PROBE_ROWS, h, PROBE_ROWS)
    near = np.abs(np.arange(h)[:, None] - borders + 0.5).min(axis=1) < NEAR_ROWS
    return 100 * float(np.mean(np.abs(with_borders - without)[near] > 1))


@contextmanager
def _one_strip() -> Generator[None]:
    """Everything at once, whatever memory it takes."""
    before = strips.ROWS, strips.VOLUME_BYTES
    strips.ROWS, strips.VOLUME_BYTES = 1 << 20, 1 << 40
    try:
        yield
    finally:
        strips.ROWS, strips.VOLUME_BYTES = before
