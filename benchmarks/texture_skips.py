"""What a picture does not need and is left out: the time that saves, and the error it adds, each by its switch."""

from collections.abc import Callable, Iterator
from functools import partial
from typing import NamedTuple

import cv2
import numpy as np

from tangible_core.data import Views
from tangible_core.metrics import segment_errors
from tangible_core.scaling import felt_factor, reduced
from tangible_core.testing.texture_scenes import KnownSegments

from .figures import table
from .texture_accuracy import found
from .texture_scenes import some
from .turns import in_turns

SEGMENTS = 4
ROUNDS = 5
SURFACE_M, FINEST_M = 0.005, 30e-6
"""A surface on which 512 pixels are finer than a Falcon resolves."""


class Skip(NamedTuple):
    """A thing left out: labels without it and with all of it, and the true ones."""

    what: str
    switch: str
    without: Callable[[], np.ndarray]
    whole: Callable[[], np.ndarray]
    truth: np.ndarray


def rows() -> list[str]:
    """A row a skip, on one mosaic."""
    scene = next(scene for scene in some().values() if scene.count == SEGMENTS)
    return table(
        ("left out", "switch", "time of all of it, ms", "time saved", "ARI with all of it", "ARI lost"),
        [_row(each) for each in skips(scene)],
    )


def _row(skip: Skip) -> tuple[str, ...]:
    times = in_turns({"whole": skip.whole, "without": skip.without}, ROUNDS)
    whole, without = (segment_errors(call(), skip.truth)["ari"] for call in (skip.whole, skip.without))
    saved = 100 * (1 - times["without"].ratio)
    return (
        skip.what,
        skip.switch,
        f"{1e3 * times['whole'].seconds:.0f}",
        f"{saved:.0f} %",
        f"{whole:.3f}",
        f"{whole - without:+.3f}",
    )


def skips(scene: KnownSegments) -> Iterator[Skip]:
    """All of them; where the mosaic does need the thing, one that does not."""
    blurred = KnownSegments(cv2.GaussianBlur(scene.picture, (0, 0), 3), scene.labels)
    for label in ("report", "gabor"):
        yield _option(label, scene, "filters without energy", "skip_weak")
        yield _option(label, blurred, "octaves above the picture's own, blurred by 3 px", "skip_octaves")
    yield Skip(
        f"pixels finer than the device resolves, on a surface {1e3 * SURFACE_M:g} mm wide, `gabor`",
        f"`workspace: finest_m`: {1e3 * FINEST_M:g} mm, 0",
        partial(_felt, scene, FINEST_M),
        partial(_felt, scene, 0.0),
        scene.labels,
    )


def _option(label: str, scene: KnownSegments, what: str, switch: str) -> Skip:
    without, whole = (partial(_labels, label, scene, **{switch: on}) for on in (True, False))
    return Skip(f"{what}, `{label}`", f"`{switch}`: true, false", without, whole, scene.labels)


def _labels(label: str, scene: KnownSegments, **options: object) -> np.ndarray:
    return found(label, scene.picture, scene.count, **options).labels


def _felt(scene: KnownSegments, finest_m: float) -> np.ndarray:
    h, w = scene.labels.shape
    small = reduced(Views(scene.picture), felt_factor(w, SURFACE_M, finest_m)).left
    labels = found("gabor", small, scene.count).labels
    return cv2.resize(labels, (w, h), interpolation=cv2.INTER_NEAREST)
