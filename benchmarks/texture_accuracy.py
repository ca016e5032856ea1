"""`gabor` and its fast option beside OpenCV's recipe: errors on every mosaic, times in turns on some."""

from collections.abc import Callable, Mapping
from functools import cache, partial
from math import prod
from typing import Any

import numpy as np

from tangible_core.data import SegmentMap
from tangible_core.metrics import segment_errors
from tangible_core.plugins.registry import load_method
from tangible_core.synthetic.texture_scenes import KnownSegments

from .figures import Figure, table
from .texture_opencv import segmented
from .texture_scenes import held_out, published, some
from .turns import Timed, in_turns

OPENCV = "opencv"
METHODS: Mapping[str, tuple[str, dict[str, Any]]] = {
    "gabor": ("gabor", {}),
    "gabor, fast": ("gabor", {"effort": "fast"}),
    "report": ("report", {}),
}
"""Label -> name and options."""
TIMED = ("gabor", "gabor, fast")
ROUNDS = 3


def found(label: str, picture: np.ndarray, segments: int, **options: object) -> SegmentMap:
    """Segments that a method of METHODS finds, told how many there are."""
    name, own = METHODS[label]
    method = load_method("texture", name).model_validate({"segments": segments, **own, **options})
    return method.segment(picture)


def calls(scene: KnownSegments) -> dict[str, Callable[[], np.ndarray]]:
    """What each does on a scene, the recipe first."""
    ours = {label: partial(_labels, label, scene) for label in METHODS}
    return {OPENCV: partial(segmented, scene.picture, scene.count), **ours}


def _labels(label: str, scene: KnownSegments) -> np.ndarray:
    return found(label, scene.picture, scene.count).labels


@cache
def errors() -> dict[str, dict[str, Mapping[str, float]]]:
    """Mosaic -> method -> `segment_errors`."""
    return {
        name: {label: segment_errors(call(), scene.labels) for label, call in calls(scene).items()}
        for name, scene in published().items()
    }


@cache
def times() -> dict[str, dict[str, Timed]]:
    """Mosaic -> method -> time beside the recipe's, on some of the mosaics."""
    timed = (OPENCV, *TIMED)
    return {name: in_turns({label: calls(scene)[label] for label in timed}, ROUNDS) for name, scene in some().items()}


def mean(label: str, measure: str) -> float:
    """Of a method, over the mosaics held out."""
    return float(np.mean([errors()[name][label][measure] for name in held_out()]))


def share(label: str) -> float:
    """Time over the recipe's, geometric mean over mosaics."""
    ratios = [each[label].ratio for each in times().values()]
    return prod(ratios) ** (1 / len(ratios))


def figures() -> list[Figure]:
    """The promises about mosaics."""
    return [_gabor(), _never_below(), _fast()]


def _gabor() -> Figure:
    ari, accuracy, boundary_px = (mean("gabor", measure) for measure in ("ari", "accuracy", "boundary_px"))
    return Figure(
        f"`gabor`, {len(held_out())} mosaics held out",
        "mean ARI >= .86 (stretch .90), accuracy >= .91, boundary <= 3 px, at <= 1/8 of OpenCV's recipe",
        f"ARI {ari:.3f}, accuracy {accuracy:.3f}, boundary {boundary_px:.1f} px, at 1/{1 / share('gabor'):.1f} "
        f"(recipe: {_recipe()})",
        ari >= 0.86 and accuracy >= 0.91 and boundary_px <= 3 and share("gabor") <= 1 / 8,
    )


def _recipe() -> str:
    ari, accuracy, boundary_px = (mean(OPENCV, measure) for measure in ("ari", "accuracy", "boundary_px"))
    seconds = np.median([each[OPENCV].seconds for each in times().values()])
    return f"{ari:.3f}, {accuracy:.3f}, {boundary_px:.1f} px, {1e3 * seconds:.0f} ms"


def _never_below() -> Figure:
    margins = {name: each["gabor"]["ari"] - each[OPENCV]["ari"] for name, each in errors().items()}
    worst = min(margins, key=margins.__getitem__)
    below = sum(margin < 0 for margin in margins.values())
    return Figure(
        f"`gabor` against the recipe, all {len(margins)} mosaics",
        "ARI never below",
        f"below on {below}; worst margin {margins[worst]:+.3f} ({worst})",
        below == 0,
    )


def _fast() -> Figure:
    ari, part = mean("gabor, fast", "ari"), share("gabor, fast")
    return Figure(
        f"`gabor`, fast option, {len(held_out())} mosaics held out",
        "mean ARI >= .82 at <= 1/20 of the recipe",
        f"ARI {ari:.3f}, accuracy {mean('gabor, fast', 'accuracy'):.3f}, at 1/{1 / part:.1f}",
        ari >= 0.82 and part <= 1 / 20,
    )


def mosaic_rows() -> list[str]:
    """ARI of each on each mosaic, and the times of ours where they were taken."""
    labels = (OPENCV, *METHODS)
    rows = [
        (
            name,
            *(f"{each[label]['ari']:.3f}" for label in labels),
            *(f"{each[label]['boundary_px']:.1f}" for label in (OPENCV, *TIMED)),
            *(f"1/{1 / times()[name][label].ratio:.1f}" if name in times() else "" for label in TIMED),
        )
        for name, each in errors().items()
    ]
    headings = (
        "mosaic",
        *(f"ARI, {label}" for label in labels),
        *(f"boundary px, {label}" for label in (OPENCV, *TIMED)),
        *(f"{label} / recipe" for label in TIMED),
    )
    return table(headings, rows)
