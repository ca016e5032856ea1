"""`gabor` on mosaics of six kinds of region, told the number of segments or not: 80 of each half of the textures."""

import re
from collections.abc import Callable, Mapping
from functools import cache
from itertools import pairwise
from time import perf_counter
from typing import NamedTuple

import numpy as np

from tangible_bench.metrics.segments import segment_errors
from tangible_core.plugins.notes import collected
from tangible_core.testing.synthetic.texture_scenes import KnownSegments
from tangible_texture import Gabor

from .figures import Figure, mean_and_error, table
from .texture_kinds import KINDS, reported_half, tuning_half
from .texture_opencv import segmented

MANY = 8  # the number of segments from which there are many
WORTHS = 0.0, 0.2, 0.4, 0.6, 0.8, 1.01
"""The borders of the confidences of guesses that are compared with the share that is right."""


class Run(NamedTuple):
    """Errors and time of one method on one mosaic."""

    errors: Mapping[str, float]
    seconds: float


METHODS: Mapping[str, Callable[[KnownSegments], np.ndarray]] = {
    "gabor": lambda scene: Gabor(segments=scene.count).segment(scene.picture).labels,
    "gabor, fast": lambda scene: Gabor(segments=scene.count, effort="fast").segment(scene.picture).labels,
    "opencv": lambda scene: segmented(scene.picture, scene.count),
}


@cache
def runs(label: str, tuning: bool) -> dict[str, Run]:
    """Mosaic -> what a method of METHODS does on it."""
    return {name: _run(METHODS[label], scene) for name, scene in _half(tuning).items()}


def _half(tuning: bool) -> dict[str, KnownSegments]:
    return tuning_half() if tuning else reported_half()


def _run(method: Callable[[KnownSegments], np.ndarray], scene: KnownSegments) -> Run:
    before = perf_counter()
    labels = method(scene)
    return Run(segment_errors(labels, scene.labels), perf_counter() - before)


def aris(label: str, tuning: bool = False, kind: str = "", least: int = 0) -> list[float]:
    """Return the ARI of a method on each mosaic of a kind, all if none is named, of `least` segments or more."""
    half = _half(tuning)
    every = runs(label, tuning).items()
    return [run.errors["ari"] for name, run in every if name.startswith(kind) and half[name].count >= least]


def share(label: str) -> float:
    """Time over the recipe's, geometric mean over the mosaics of the reported half."""
    logs = [np.log(run.seconds / runs("opencv", False)[name].seconds) for name, run in runs(label, False).items()]
    return float(np.exp(np.mean(logs)))


def figures() -> list[Figure]:
    """Return the promises about mosaics of textures that nothing was tuned on."""
    return [_told(), _never_below(), _fast(), _counted()]


def _told() -> Figure:
    every, letters, many = aris("gabor"), aris("gabor", kind="letters"), aris("gabor", least=MANY)
    boundary_px = np.median([run.errors["boundary_px"] for run in runs("gabor", False).values()])
    means = [float(np.mean(each)) for each in (every, letters, many)]
    return Figure(
        f"`gabor`, {len(every)} mosaics of the reported half",
        "mean ARI >= .89, of letters >= .72, of 8 segments or more >= .89, median boundary <= 2.5 px, at <= 1/10 of "
        "OpenCV's recipe",
        f"ARI {mean_and_error(every)}, of letters {mean_and_error(letters)}, of 8 or more {mean_and_error(many)}, "
        f"boundary {boundary_px:.1f} px, at 1/{1 / share('gabor'):.1f} (recipe: {mean_and_error(aris('opencv'))}; "
        f"tuning half: {mean_and_error(aris('gabor', tuning=True))})",
        bool(means[0] >= 0.89 and means[1] >= 0.72 and means[2] >= 0.89 and boundary_px <= 2.5)
        and share("gabor") <= 1 / 10,
    )


def _never_below() -> Figure:
    recipe = runs("opencv", False)
    margins = {name: run.errors["ari"] - recipe[name].errors["ari"] for name, run in runs("gabor", False).items()}
    worst = min(margins, key=margins.__getitem__)
    below = sum(margin < -0.01 for margin in margins.values())
    return Figure(
        f"`gabor` against the recipe, {len(margins)} mosaics of the reported half",
        "ARI never below by more than .01",
        f"below on {below}; worst margin {margins[worst]:+.3f} ({worst}), "
        f"mean {mean_and_error(list(margins.values()))}",
        below == 0,
    )


def _fast() -> Figure:
    ours, fast = aris("gabor"), aris("gabor, fast")
    behind = [one - other for one, other in zip(ours, fast, strict=True)]
    part = share("gabor, fast")
    return Figure(
        f"`gabor`, fast option, {len(fast)} mosaics of the reported half",
        "mean ARI at most .025 below `gabor`'s, at <= 1/12 of the recipe",
        f"ARI {mean_and_error(fast)}, below by {mean_and_error(behind)}, at 1/{1 / part:.1f}",
        float(np.mean(behind)) <= 0.025 and part <= 1 / 12,
    )


def _counted() -> Figure:
    guesses = np.array([(*guess(scene.picture), scene.count) for scene in reported_half().values()])
    off, worth = np.abs(guesses[:, 0] - guesses[:, 2]), guesses[:, 1]
    groups = [(worth >= low) & (worth < high) for low, high in pairwise(WORTHS)]
    rates = [(int(group.sum()), worth[group].mean(), (off[group] == 0).mean()) for group in groups if group.any()]
    exact, near = np.mean(off == 0), np.mean(off <= 1)
    return Figure(
        f"number of segments that `gabor` finds by itself, {len(off)} mosaics of the reported half",
        "exact >= 60 %, within one >= 85 %; of guesses worth p, p are right, within .1",
        f"exact {100 * exact:.0f} %, within one {100 * near:.0f} %; "
        + "; ".join(f"of {count} worth {said:.2f}, {right:.2f} are right" for count, said, right in rates),
        bool(exact >= 0.6 and near >= 0.85) and all(abs(said - right) <= 0.1 for _, said, right in rates),
    )


def guess(picture: np.ndarray) -> tuple[int, float]:
    """Return the number of segments found, and the confidence of that; 1 where nothing was guessed."""
    with collected() as notes:
        count = Gabor().segment(picture).count
    worth = [float(found[1]) for note in notes if (found := re.search(r"estimated with confidence ([\d.]+):", note))]
    return count, worth[0] if worth else 1.0


def kind_rows() -> list[str]:
    """Return the ARI of each method on each kind of region, and of `gabor` on the tuning half."""
    rows = [
        (
            kind,
            *(mean_and_error(aris(label, kind=kind)) for label in METHODS),
            mean_and_error(aris("gabor", True, kind)),
        )
        for kind in KINDS
    ]
    return table(("regions", *(f"ARI, {label}" for label in METHODS), "ARI, gabor, tuning half"), rows)
