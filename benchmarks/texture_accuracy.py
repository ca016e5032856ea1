"""`gabor` and its fast option beside OpenCV's recipe: errors on every mosaic, times in turns on some."""

import re
from collections.abc import Callable, Mapping
from functools import cache, partial
from math import prod
from typing import Any

import numpy as np

from tangible_bench.metrics.segments import segment_errors
from tangible_core.data import SegmentMap
from tangible_core.plugins.notes import collected
from tangible_core.plugins.registry import load_method
from tangible_core.testing.synthetic.texture_scenes import KnownSegments

from .figures import Figure, table
from .texture_opencv import segmented
from .texture_scenes import SEGMENTS, held_out, published, some
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
    """Return the result of each method on a scene, the recipe first."""
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
    """Return the promises about mosaics."""
    return [_gabor(), _never_below(), _fast(), _counted()]


def _gabor() -> Figure:
    ari, accuracy = (mean("gabor", measure) for measure in ("ari", "accuracy"))
    found = {name: errors()[name]["gabor"] for name in held_out()}
    boundary_px = np.median([each["boundary_px"] for each in found.values()])
    eight = np.mean([each["ari"] for name, each in found.items() if held_out()[name].count == SEGMENTS[-1]])
    return Figure(
        f"`gabor`, {len(held_out())} mosaics held out",
        "mean ARI >= .94, of eight >= .92, median boundary <= 2.5 px, at <= 1/8 of OpenCV's recipe",
        f"ARI {ari:.3f}, of eight {eight:.3f}, accuracy {accuracy:.3f}, boundary {boundary_px:.1f} px, "
        f"at 1/{1 / share('gabor'):.1f} (recipe: {_recipe()})",
        bool(ari >= 0.94 and eight >= 0.92 and boundary_px <= 2.5 and share("gabor") <= 1 / 8),
    )


def _recipe() -> str:
    ari, accuracy, boundary_px = (mean(OPENCV, measure) for measure in ("ari", "accuracy", "boundary_px"))
    seconds = np.median([each[OPENCV].seconds for each in times().values()])
    return f"{ari:.3f}, {accuracy:.3f}, {boundary_px:.1f} px, {1e3 * seconds:.0f} ms"


def _never_below() -> Figure:
    margins = {name: each["gabor"]["ari"] - each[OPENCV]["ari"] for name, each in errors().items()}
    worst = min(margins, key=margins.__getitem__)
    below = sum(margin < -0.05 for margin in margins.values())
    return Figure(
        f"`gabor` against the recipe, all {len(margins)} mosaics",
        "ARI never below by more than .05",
        f"below on {below}; worst margin {margins[worst]:+.3f} ({worst})",
        below == 0,
    )


def _fast() -> Figure:
    ari, part = mean("gabor, fast", "ari"), share("gabor, fast")
    return Figure(
        f"`gabor`, fast option, {len(held_out())} mosaics held out",
        "mean ARI >= .92 at <= 1/15 of the recipe",
        f"ARI {ari:.3f}, accuracy {mean('gabor, fast', 'accuracy'):.3f}, at 1/{1 / part:.1f}",
        ari >= 0.92 and part <= 1 / 15,
    )


def _counted() -> Figure:
    guesses = np.array([(*guess(scene.picture), scene.count) for scene in published().values()])
    off = np.abs(guesses[:, 0] - guesses[:, 2])
    about = (guesses[:, 1] >= 0.7) & (guesses[:, 1] < 0.9)
    exact, near = np.mean(off == 0), np.mean(off <= 1)
    worth, right = (guesses[about, 1].mean(), np.mean(off[about] == 0)) if about.any() else (1.0, 0.0)
    return Figure(
        f"number of segments that `gabor` finds by itself, all {len(off)} mosaics",
        "exact >= 65 %, within one >= 90 %; guesses worth .8 are right in 8 of 10, within .1",
        f"exact {100 * exact:.0f} %, within one {100 * near:.0f} %; "
        + (
            f"of {about.sum()} guesses worth .7 to .9, {worth:.2f} on average, {100 * right:.0f} % are right"
            if about.any()
            else f"no guess is worth .7 to .9, they are worth {guesses[:, 1].min():.2f} to {guesses[:, 1].max():.2f}"
        ),
        bool(exact >= 0.65 and near >= 0.9 and abs(right - worth) <= 0.1),
    )


def guess(picture: np.ndarray) -> tuple[int, float]:
    """Return the number of segments found, and the confidence of that; 1 where nothing was guessed."""
    with collected() as notes:
        count = load_method("texture", "gabor")().segment(picture).count
    worth = [float(found[1]) for each in notes if (found := re.search(r"estimated with confidence ([\d.]+):", each))]
    return count, worth[0] if worth else 1.0


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
