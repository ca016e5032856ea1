"""What a picture does not need and is left out: the time that saves, and the error it adds, each by its switch."""

from collections.abc import Callable, Iterator
from functools import partial
from typing import NamedTuple

import cv2
import numpy as np

from tangible_bench.metrics.segments import segment_errors
from tangible_core.data import Views
from tangible_core.scene.scaling import enlarged_segments, felt_factor, reduce_views
from tangible_core.testing.synthetic.texture_scenes import KnownSegments

from .figures import table
from .texture_accuracy import found
from .texture_scenes import some
from .turns import in_turns

SEGMENTS = 4
ROUNDS = 3
BLUR_PX = 3.0
"""A mosaic blurred so far has no fine octaves."""
SURFACE_M, FINEST_M = 0.0075, 30e-6
"""A surface on which 512 pixels are finer than a Falcon resolves."""


class Skip(NamedTuple):
    """A thing left out: labels without it and with all of it, and the true ones."""

    what: str
    switch: str
    without: Callable[[], np.ndarray]
    whole: Callable[[], np.ndarray]
    truth: np.ndarray


def rows() -> list[str]:
    """Return a row a skip, on one mosaic."""
    scene = next(scene for scene in some().values() if scene.count == SEGMENTS)
    return table(
        ("left out", "switch", "time of all of it, ms", "time saved", "ARI with all of it", "ARI lost"),
        [_row(each) for each in skips(scene)],
    )


def exact() -> str:
    """Yield what is known before any search: no error, and next to no time."""
    picture = next(iter(some().values())).picture
    calls = {
        "whole": partial(found, "gabor", picture, SEGMENTS),
        "one": partial(found, "gabor", picture, 1),
        "flat": partial(found, "gabor", np.full_like(picture, 128), SEGMENTS),
    }
    times = {name: 1e3 * each.seconds for name, each in in_turns(calls, ROUNDS).items()}
    return (
        f"Without any error: `gabor` takes {times['one']:.1f} ms where one segment is asked for and "
        f"{times['flat']:.1f} ms on one flat colour, instead of {times['whole']:.0f} ms."
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
    """All that change what is found; where the mosaic does need the thing, one that does not."""
    blurred = KnownSegments(cv2.GaussianBlur(scene.picture, (0, 0), BLUR_PX), scene.labels)
    coloured = KnownSegments(np.dstack([scene.picture] * 3), scene.labels)
    yield _option("weak filters", "report", scene, "skip_weak", True, False)
    yield _option("octaves that are not there", "report", blurred, "skip_octaves", True, False)
    yield _option("filters without energy", "gabor", blurred, "least_energy", 1e-4, 0)
    yield _option("colour that is not there", "gabor", coloured, "colour", "auto", True)
    yield _option(
        "a finer division, and axes found anew for more of the joinings", "gabor", scene, "effort", "fast", "balanced"
    )
    yield Skip(
        f"pixels finer than the device resolves, on a surface {1e3 * SURFACE_M:g} mm wide, `gabor`",
        f"`workspace: finest_m`: {1e3 * FINEST_M:g} mm, 0",
        partial(_felt, scene, FINEST_M),
        partial(_felt, scene, 0.0),
        scene.labels,
    )


def _option(what: str, label: str, scene: KnownSegments, switch: str, less: object, more: object) -> Skip:
    without, whole = (partial(_labels, label, scene, **{switch: value}) for value in (less, more))
    return Skip(f"{what}, `{label}`", f"`{switch}`: {less}, {more}", without, whole, scene.labels)


def _labels(label: str, scene: KnownSegments, **options: object) -> np.ndarray:
    return found(label, scene.picture, scene.count, **options).labels


def _felt(scene: KnownSegments, finest_m: float) -> np.ndarray:
    h, w = scene.labels.shape
    small = reduce_views(Views(scene.picture), felt_factor(w, SURFACE_M, finest_m)).left
    return enlarged_segments(found("gabor", small, scene.count), (h, w)).labels
