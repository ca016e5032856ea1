"""Time and memory of `gabor` as pictures grow."""

from functools import partial

import numpy as np

from tangible_texture import Gabor

from .figures import Figure, table
from .texture_scenes import held_out
from .turns import peak_bytes, seconds

SIDES_PX = (256, 512, 1024, 2048, 4096)  # a mosaic, cut or mirrored over and over: 0.07 to 17 megapixels
SEGMENTS = 4
ROUNDS = 3
MEMORY_BYTES_PX, MEMORY_BYTES = 64, 16 << 20  # what `gabor` states


def measured() -> tuple[list[Figure], list[str]]:
    """Return the promises about growth, and a row a size."""
    calls = [partial(Gabor(segments=SEGMENTS).segment, _picture(side)) for side in SIDES_PX]
    memory = [peak_bytes(call) for call in calls]
    times = np.array([[seconds(call) for call in calls] for _ in range(ROUNDS)]).min(axis=0)
    pixels = np.square(SIDES_PX)
    costs = 1e9 * times / pixels
    time = Figure(
        f"cost of `gabor` as work grows, {pixels[0] / 1e6:.2f} to {pixels[-1] / 1e6:.0f} Mpx",
        "time per pixel within 3.5 x of its best",
        f"least of {ROUNDS} rounds: {costs.min():.0f} to {costs.max():.0f} ns: {costs.max() / costs.min():.2f} x",
        bool(costs.max() <= 3.5 * costs.min()),
    )
    bounds = MEMORY_BYTES_PX * pixels + MEMORY_BYTES
    peak = Figure(
        "memory of `gabor` above the picture",
        f"bounded and stated: {MEMORY_BYTES_PX} bytes a pixel and {MEMORY_BYTES >> 20} MiB",
        f"{memory[-1] / 2**20:.0f} MiB at {pixels[-1] / 1e6:.0f} Mpx, stated {bounds[-1] / 2**20:.0f}",
        bool(np.all(np.array(memory) <= bounds)),
    )
    rows = [
        (f"{count / 1e6:.2f}", f"{1e3 * spent:.0f}", f"{cost:.0f}", f"{used / 2**20:.0f}")
        for count, spent, cost, used in zip(pixels, times, costs, memory, strict=True)
    ]
    return [time, peak], table(("Mpx", "ms", "ns / px", "peak MiB"), rows)


def _picture(side_px: int) -> np.ndarray:
    scene = next(scene for scene in held_out().values() if scene.count == SEGMENTS)
    grey = scene.picture[:side_px, :side_px]
    return np.pad(grey, [(0, side_px - has) for has in grey.shape], mode="symmetric")
