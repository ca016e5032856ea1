"""The task for texture methods: segments compared with the true ones, whatever their numbers."""

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np

from tangible_core.data import SegmentMap
from tangible_core.plugins import Segmenter
from tangible_core.testing.synthetic import KnownSegments

from ..metrics.segments import segment_errors
from . import damage, transforms
from .task import Measure, Perturbation, Task
from .texture_scenes import TextureScene


def segment(method: Segmenter, scene: KnownSegments) -> SegmentMap:
    """Run the timed call."""
    return method.segment(scene.picture)


def measure(segments: SegmentMap, scene: KnownSegments) -> dict[str, float]:
    """Return `segment_errors`, where `segments` is the difference between the number of segments and the true one."""
    errors = segment_errors(segments.labels, scene.labels)
    return errors | {"segments": abs(errors["segments"] - scene.count)}


def _light(change: Callable[[np.ndarray, float], np.ndarray]) -> Callable[[KnownSegments, float], KnownSegments]:
    """Return a perturbation of the picture that moves no pixel."""
    return lambda scene, value: replace(scene, picture=change(scene.picture, value))


PERTURBATIONS: Mapping[str, Perturbation] = {
    "noise": Perturbation(
        "standard deviation in grey levels of 255, above 0",
        lambda sd: 0 < sd <= 255,
        _light(lambda picture, sd: damage.noise(picture, sd, seed=0)),
    ),
    "gain": Perturbation("factor, above 0", lambda factor: 0 < factor <= 10, _light(damage.gain)),
    "offset": Perturbation("grey levels of 255 to add", lambda levels: abs(levels) <= 255, _light(damage.offset)),
    "light": Perturbation(
        "share by which the light rises from the middle to the right border, -1 to 1",
        lambda share: 0 < abs(share) <= 1,
        _light(damage.light),
    ),
    "quarter": Perturbation(
        "turns by 90 degrees to the left: 1, 2 or 3", lambda turns: turns in (1, 2, 3), transforms.quarter
    ),
    "rotate": Perturbation(
        "degrees to the left, within 45; the largest part without empty corners",
        lambda degrees: 0 < abs(degrees) <= 45,
        transforms.rotate,
    ),
    "flip": Perturbation("1 left for right, 0 top for bottom", lambda axis: axis in (0, 1), transforms.flip),
    "scale": Perturbation("factor on both sides, 0.1 to 10", lambda factor: 0.1 <= factor <= 10, transforms.scale),
}

MEASURES = {
    "ari": Measure("ARI", 3, "high", tolerance=0.0005),
    "accuracy": Measure("accuracy", 3, "high", tolerance=0.0005),
    "boundary_px": Measure("boundary px", 1, tolerance=0.05),
    "segments": Measure("segments off", 1, tolerance=0.05),
}

TASK = Task(
    kind="texture",
    version=1,
    scene=TextureScene,
    work=segment,
    measure=measure,
    measures=MEASURES,
    columns=tuple(MEASURES),
    plotted=("ari", "boundary_px"),
    perturbations=PERTURBATIONS,
    given={"segments": lambda scene: scene.count},
)
