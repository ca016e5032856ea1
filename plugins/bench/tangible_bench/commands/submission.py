"""Submissions: disparity maps of a comparison's methods in the formats of benchmarks; the time of one call each."""

from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass
from pathlib import Path
from time import perf_counter

import numpy as np
import typer

from tangible_core.cli import FAILED, is_quiet, show
from tangible_core.data import Outcome
from tangible_core.errors import ConfigError, OutputError, PictureError, TangibleError
from tangible_core.plugins import hooks
from tangible_core.plugins.failures import sentence
from tangible_core.plugins.registry import default_registry

from ..config.methods import Entry
from ..config.reading import Comparison
from ..datasets.submissions import WRITERS, write_submission
from ..tasks.depth import Pair, estimate
from ..tasks.depth_scenes import DepthScene


@dataclass(frozen=True)
class Submitted:
    """The result of a method on a pair."""

    method: str
    scene: str
    files: tuple[Path, ...] = ()
    seconds: float = 0.0
    error: str = ""
    """The reason why there are no files; empty if there are some."""


def submit(
    comparison: Comparison, folder: Path, on_start: Callable[[str, str], None] = lambda method, scene: None
) -> Iterator[Submitted]:
    """Run every method on every pair of a set that takes submissions. Raises: ConfigError, OutputError."""
    scenes = {
        name: spec
        for name, spec in comparison.scenes.items()
        if isinstance(spec, DepthScene) and spec.set is not None and spec.set in WRITERS
    }
    if not scenes:
        raise ConfigError(f"{comparison.path}: no scene is from a set that takes submissions: {', '.join(WRITERS)}")
    warm = set[str]()
    for name, spec in scenes.items():
        pair = spec.open()
        for entry in comparison.methods:
            on_start(entry.label, name)
            try:
                yield _submit_pair(comparison, folder, entry, name, spec, pair, warm)
            except (OutputError, ConfigError):
                raise
            except Exception as error:  # noqa: BLE001 - whatever a method raises is that method's result
                message = str(error) if isinstance(error, TangibleError) else sentence(error)
                yield Submitted(entry.label, name, error=message)


def _submit_pair(
    comparison: Comparison, folder: Path, entry: Entry, name: str, spec: DepthScene, pair: Pair, warm: set[str]
) -> Submitted:
    assert spec.set is not None
    (standard_pair,) = spec.list_pairs()
    method = entry.method_for({key: fact_of(pair) for key, fact_of in comparison.task.facts.items()})
    if entry.label not in warm:  # so that imports and compilation are not in its time
        estimate(method, pair)  # pyright: ignore[reportArgumentType] - of the kind that is compared
        warm.add(entry.label)
    start_s = perf_counter()
    disparity = estimate(method, pair)  # pyright: ignore[reportArgumentType]
    seconds = perf_counter() - start_s
    for key, labels in comparison.finishes.items():
        if entry.label in labels:
            disparity = comparison.task.finishes[key](disparity)
    disparity_px, unit = np.asarray(disparity.disparity_px), disparity.unit
    if unit != "px" or disparity_px.shape != pair.views.shape:
        raise PictureError(
            f"its disparity is in {unit}, {disparity_px.shape}; a submission needs px, {pair.views.shape}"
        )
    files = write_submission(folder, spec.set, entry.label, standard_pair, disparity_px, seconds)
    return Submitted(entry.label, name, files, seconds)


def write_submissions(comparison: Comparison, folder: Path, as_json: bool) -> None:
    """Write the disparity maps of all methods. Raises: Exit with 1 if a method has no result on a pair."""
    plugins = default_registry().plugins

    def report_start(method: str, scene: str) -> None:
        hooks.tell(plugins, "tangible_stage_started", product=scene, method=method)

    results: list[Submitted] = []
    for result in submit(comparison, folder, report_start):
        results.append(result)
        kind, why = ("failed", result.error) if result.error else ("ran", "written")
        outcome = Outcome(result.scene, kind, why, result.method, result.seconds)
        hooks.tell(plugins, "tangible_stage_finished", outcome=outcome)
    failures = [result for result in results if result.error]
    if as_json:
        show.print_json([{**asdict(result), "files": [str(path) for path in result.files]} for result in results])
    elif not is_quiet():
        for method in dict.fromkeys(result.method for result in results):
            count = sum(len(result.files) for result in results if result.method == method)
            show.plain(f"{method}: {count} files in {folder}")
    for result in failures:
        show.flush()
        show.note(f"no result of {result.method} on {result.scene}: {result.error}")
    if failures:
        raise typer.Exit(FAILED)
