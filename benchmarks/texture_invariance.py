"""What must not change the segments of `gabor`: light, turns, a little noise, the seed; and what must give only one."""

from collections.abc import Callable, Iterator
from functools import cache

import numpy as np

from tangible_bench.metrics.segments import segment_errors
from tangible_bench.tasks.damage import noise
from tangible_core.plugins.registry import default_registry, load_method

from .figures import Figure
from .texture_accuracy import found
from .texture_scenes import some

Change = Callable[[np.ndarray], np.ndarray]
LIGHT: dict[str, Change] = {
    "gain 0.4": lambda picture: 0.4 / 255 * picture,
    "gain 0.5 and offset 0.3": lambda picture: 0.5 / 255 * picture + 0.3,
    "16 bits": lambda picture: picture.astype(np.uint16) * 257,
}
TURNS: dict[str, tuple[Change, Change]] = {
    "left for right": (np.fliplr, np.fliplr),
    "top for bottom": (np.flipud, np.flipud),
    **{f"{90 * n} degrees": (lambda a, n=n: np.rot90(a, n), lambda a, n=n: np.rot90(a, -n)) for n in (1, 2, 3)},
}
"""(there, back)."""
FLAT: dict[str, np.ndarray] = {
    "constant": np.full((96, 128), 77, np.uint8),
    "one pixel + 1": np.full((96, 128), 77, np.uint8),
    "checkerboard": (255 * (np.indices((96, 128)).sum(axis=0) % 2)).astype(np.uint8),
}
FLAT["one pixel + 1"][40, 60] += 1


def figures() -> list[Figure]:
    """Return the promises about what must not matter."""
    light = {what: list(_against_plain(change, lambda labels: labels)) for what, change in LIGHT.items()}
    turns = {what: list(_against_plain(*pair)) for what, pair in TURNS.items()}
    noisy = {"sd 8": list(_against_plain(lambda picture: noise(picture, 8, 0), lambda labels: labels))}
    again = {"draws nothing: once more": list(_against_plain(np.copy, np.copy))}
    return [
        _figure("gain and offset", 1.0, light),
        _figure("flips and quarter turns", 0.995, turns),
        _figure("noise, sd 8 of 255", 0.95, noisy),
        _figure("seeds", 0.99, again),
        _floor(),
    ]


def _against_plain(there: Change, back: Change) -> Iterator[float]:
    """ARI of the segments of each changed mosaic, put back, to those of the plain one."""
    for name, scene in some().items():
        changed = found("gabor", np.ascontiguousarray(there(scene.picture)), scene.count).labels
        yield segment_errors(back(changed), _plain()[name])["ari"]


@cache
def _plain() -> dict[str, np.ndarray]:
    return {name: found("gabor", scene.picture, scene.count).labels for name, scene in some().items()}


def _figure(what: str, bound: float, agreements: dict[str, list[float]]) -> Figure:
    worst = min(agreements, key=lambda name: min(agreements[name]))
    lowest = min(agreements[worst])
    mean = np.mean(list(agreements.values()))
    return Figure(
        f"invariance of `gabor`: {what}",
        f"ARI to the plain segments >= {bound:g}",
        f"mean {mean:.4f}, worst {lowest:.4f} ({worst}; {len(some())} mosaics)",
        lowest >= bound,
    )


def _floor() -> Figure:
    names = sorted(each.name for each in default_registry().listings if each.kind == "texture")
    counts = {
        (name, what, k): load_method("texture", name).model_validate({"segments": k}).segment(picture).count
        for name in names
        for what, picture in FLAT.items()
        for k in (1, 2, 3, 8)
    }
    more = sorted({f"{name} on {what}" for (name, what, _), count in counts.items() if count > 1})
    return Figure(
        f"noise floor: {', '.join(FLAT)}; k = 1, 2, 3, 8",
        "1 segment",
        f"1 segment by all of {', '.join(names)}" if not more else f"more than one: {', '.join(more)}",
        not more,
    )
