"""The disparity maps of a comparison's methods, as benchmarks take them; nothing is measured but one call's time."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter

import numpy as np

from tangible_core.errors import ConfigError, OutputError, PictureError, TangibleError
from tangible_core.plugins.failures import sentence

from .config.methods import Entry
from .config.reading import Comparison
from .datasets.submissions import WRITERS, write_submission
from .tasks.depth import Pair, estimate
from .tasks.depth_scenes import DepthScene


@dataclass(frozen=True)
class Submitted:
    """What became of a method on a pair."""

    method: str
    scene: str
    files: tuple[Path, ...] = ()
    seconds: float = 0.0
    error: str = ""
    """Why there is no file; empty if there are."""


def submit(
    comparison: Comparison, folder: Path, started: Callable[[str, str], None] = lambda method, scene: None
) -> Iterator[Submitted]:
    """Every method on every pair of a set that takes submissions, one after the other; each pair's files as they come.

    Each method is called twice on its first pair, so that imports and compilation are not in its time. `fill:` is
    heeded, perturbations are not.
    started: hears of the method and the scene before each.
    Raises: ConfigError if no scene is of such a set, OutputError if the folder cannot be written.
    """
    scenes = {
        name: spec
        for name, spec in comparison.scenes.items()
        if isinstance(spec, DepthScene) and spec.set is not None and spec.set in WRITERS
    }
    if not scenes:
        raise ConfigError(f"{comparison.path}: no scene is of a set that takes submissions: {', '.join(WRITERS)}")
    warm = set[str]()
    for name, spec in scenes.items():
        pair = spec.open()
        for entry in comparison.methods:
            started(entry.label, name)
            try:
                yield _one(comparison, folder, entry, name, spec, pair, warm)
            except (OutputError, ConfigError):
                raise
            except Exception as error:  # noqa: BLE001 - whatever a method raises is that method's result
                yield Submitted(
                    entry.label, name, error=str(error) if isinstance(error, TangibleError) else sentence(error)
                )


def _one(
    comparison: Comparison, folder: Path, entry: Entry, name: str, spec: DepthScene, pair: Pair, warm: set[str]
) -> Submitted:
    assert spec.set is not None
    (listed,) = spec.listed()
    method = entry.method_for({key: tell(pair) for key, tell in comparison.task.given.items()})
    if entry.label not in warm:
        estimate(method, pair)  # pyright: ignore[reportArgumentType] - of the kind that is compared
        warm.add(entry.label)
    began = perf_counter()
    found = estimate(method, pair)  # pyright: ignore[reportArgumentType]
    seconds = perf_counter() - began
    for key, labels in comparison.finishes.items():
        if entry.label in labels:
            found = comparison.task.finishes[key](found)
    if found.unit != "px" or found.disparity_px.shape != pair.views.shape:
        raise PictureError(
            f"its disparity is in {found.unit}, {found.disparity_px.shape}; to be submitted are px, {pair.views.shape}"
        )
    disparity_px = np.asarray(found.disparity_px)
    files = write_submission(folder, spec.set, entry.label, listed, disparity_px, seconds)
    return Submitted(entry.label, name, files, seconds)
