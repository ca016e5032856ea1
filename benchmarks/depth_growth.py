"""Time and memory as pictures grow."""

from collections.abc import Mapping
from functools import partial
from typing import Literal

import numpy as np

from tangible_depth.semi_global import SemiGlobal
from tangible_depth.sgm import strips

from .depth_opencv import filled
from .depth_pairs import KnownScene, real
from .figures import Figure, table
from .turns import peak_bytes, seconds

DISPARITIES = 128
# The builtin pair this often side by side and below itself: 0.4 to 18 megapixels, all with the same disparities.
TILES = (1, 2, 3, 5, 7)
VOLUMES_BYTES = strips.VOLUME_BYTES
Effort = Literal["balanced", "best"]
# What `semi-global` states, as VOLUMES_BYTES.
MEMORY_BYTES_PX: Mapping[Effort, int] = {"balanced": 25, "best": 32}
OF: Mapping[Effort, str] = {"balanced": "", "best": ", `effort: best`"}
Size = tuple[float, float, float, float]
ROUNDS = 5


def measured() -> tuple[list[Figure], list[str]]:
    """Return the promises about growth, and a row a size, of the default."""
    default = _sizes("balanced")
    figures = [*_promises("balanced", default), *_promises("best", _sizes("best"))]
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
    pixels = [row[0] * 1e6 for row in rows]
    memory = [row[2] for row in rows]
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
    """Megapixels, least ns a pixel and disparity, peak bytes, and time over 3WAY's, for each of TILES."""
    scenes = [_tiled(count) for count in TILES]
    method = SemiGlobal(max_disparity_px=DISPARITIES, effort=effort)
    calls = [partial(method.estimate, each.views) for each in scenes]
    memory = [peak_bytes(call) for call in calls]
    times = [
        [(seconds(partial(filled, each)), seconds(call)) for each, call in zip(scenes, calls, strict=True)]
        for _ in range(ROUNDS)
    ]
    found = []
    for i, scene in enumerate(scenes):
        pixels = scene.grey.left.size
        theirs, ours = np.array([time[i] for time in times]).T
        found.append((pixels / 1e6, 1e9 * min(ours) / pixels / DISPARITIES, memory[i], float(np.median(ours / theirs))))
    return found


def _tiled(count: int) -> KnownScene:
    scene = real()["motorcycle"]
    grey = scene.grey._replace(
        left=np.tile(scene.grey.left, (count, count)), right=np.tile(scene.grey.right, (count, count))
    )
    return KnownScene(scene.pair, grey, DISPARITIES)
