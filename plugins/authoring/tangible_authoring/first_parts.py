"""The first parts of a picture, for a person to name, correct and paint over: a label picture and a pipeline file."""

from collections.abc import Generator, Iterable, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from math import ceil, floor
from pathlib import Path
from time import perf_counter

import numpy as np

from tangible_authoring.label_picture import label_picture
from tangible_core.data import Figure, Outcome, PartMap, SegmentMap
from tangible_core.errors import ConfigError, OutputError, check_positive
from tangible_core.files import atomic_write, sole_writer
from tangible_core.files.yaml import on_one_line
from tangible_core.parts import HeightChoice, PartChoice, PartHeights
from tangible_core.pipeline import SIDE_MM, Pipeline
from tangible_core.pipeline.config import parse_config
from tangible_core.pipeline.engine import Cache, choose_heights
from tangible_core.pipeline.starter import starter
from tangible_core.plugins import hooks
from tangible_core.plugins.registry import Registry, default_registry
from tangible_core.scene import Scene
from tangible_core.scene.formats import file_kind
from tangible_legibility.simplifying.large import large_parts
from tangible_networks.store import networks_here
from tangible_report.numbered_parts import numbered_parts

from .listed_parts import RELIEF_MM, ListedPart, list_rows, make_title, parts_starter

LABELS, NUMBERED = "parts.png", "parts-numbered.png"
MAX_PARTS = 12  # a person names these in a few minutes, and fingers tell them apart
SMALLEST_MM = 5.0  # disc that each part must hold: narrower ones are felt as edges
SEGMENTS_PER_PART = 4 / 3  # requested: segments that are too small go to their neighbours
THE_FIGURE = "the figure"  # what a network sees stand out from its ground
# Share of the height for the parts of the ground where a network sees a figure; those of the figure have the rest.
GROUND = 0.5
STEPS_PER_M = 10_000  # a tenth of a millimetre is easy to read, and nobody feels less


@dataclass(frozen=True, eq=False)
class FirstParts:
    """The parts that were found in a picture, and the content of the files about them."""

    scene: Scene
    parts: PartMap
    listed: tuple[ListedPart, ...]
    title: str
    method: str
    contents: Mapping[Path, bytes]
    """The content of the files by path: label picture, numbers, pipeline file. The pipeline file is the last, so that
    it never names a missing file."""

    def write(self, force: bool = False) -> tuple[Path, ...]:
        """Write the files, each whole or not at all. force: overwrite existing ones. Raises: OutputError."""
        with sole_writer(next(iter(self.contents))):
            check_free(self.contents, force=force)
            for path, content in self.contents.items():
                with atomic_write(path) as file:
                    file.write(content)
        return tuple(self.contents)


def files_beside(file: Path) -> tuple[Path, Path, Path]:
    """Return the paths of the label picture and the numbers next to a pipeline file, and of the file itself."""
    return file.parent / LABELS, file.parent / NUMBERED, file


def check_free(paths: Iterable[Path], pictures: Sequence[Path] = (), force: bool = False) -> None:
    """Refuse to overwrite. Raises: OutputError for the first path that exists, or is a picture, forced or not."""
    for path in paths:
        if any(path.exists() and picture.exists() and path.samefile(picture) for picture in pictures):
            raise OutputError(f"{path}: is the picture itself; --out FOLDER writes to another folder")
        if path.exists() and not force:
            raise OutputError(
                f"{path}: is there already; --out FOLDER writes to another folder, --force writes over it"
            )


def first_parts(
    pictures: Sequence[Path],
    file: Path,
    *,
    method: str = "",
    overrides: Sequence[str] = (),
    most: int = MAX_PARTS,
    smallest_mm: float = SMALLEST_MM,
    registry: Registry | None = None,
    cache: Cache | None = None,
) -> FirstParts:
    """Find the parts of a photo, or of a pair, whose heights are then by depth; `FirstParts.write` writes the files."""
    if most < 1:
        raise ConfigError(f"count: must be at least 1, not {most}")
    check_positive("smallest", smallest_mm)
    pipeline = _pipeline(pictures, file, method, overrides, most, registry or default_registry(), cache)
    scene, parts = pipeline.scene, proposed_parts(pipeline, most, smallest_mm)
    assert scene.views is not None
    heights = proposed_heights(pipeline, parts)
    front = _figure(pipeline).front_parts(parts)
    choices = {number: PartChoice(name=THE_FIGURE) for number in front if len(front) == 1}
    rows, title = list_rows(parts, heights, choices), make_title(pictures[0])
    text = parts_starter(pipeline, file, LABELS, NUMBERED, title, rows)
    labels, numbers_path, _ = files_beside(file)
    numbered_png = numbered_parts(scene.views.left, parts)
    contents = {labels: label_picture(parts.labels), numbers_path: numbered_png, file: text.encode()}
    texture = pipeline.config.texture
    return FirstParts(scene, parts, rows, title, texture.name if texture else "", contents)


def proposed_parts(pipeline: Pipeline, most: int = MAX_PARTS, smallest_mm: float = SMALLEST_MM) -> PartMap:
    """Find the parts of a pipeline's picture: its segments, joined until they are few and large."""
    scene, segments = pipeline.scene, pipeline.make("segments")
    assert scene.views is not None
    if segments is None:
        segments = SegmentMap(np.zeros(scene.shape, np.int32))
    with _observers_notified(pipeline.engine.registry):
        figure = _figure(pipeline).is_figure(segments.labels.shape)
        if figure.any():
            segments = SegmentMap(2 * segments.labels + figure.astype(np.int32))
        return large_parts(segments, scene.views.left, smallest_mm / SIDE_MM * max(scene.shape), most)


def _figure(pipeline: Pipeline) -> Figure:
    views = pipeline.scene.views
    one_picture = views is not None and views.right is None
    return pipeline.make("figure") if one_picture and networks_here("figure") else Figure()


def segments_for(most: int = MAX_PARTS) -> int:
    """Return the number of segments that is requested of a texture method for at most this many parts."""
    return ceil(SEGMENTS_PER_PART * most)


def _pipeline(
    pictures: Sequence[Path],
    file: Path,
    method: str,
    overrides: Sequence[str],
    most: int,
    registry: Registry,
    cache: Cache | None,
) -> Pipeline:
    if method:
        registry.find("texture", method)
    if other := next((override for override in overrides if not override.lstrip().startswith("texture.")), None):
        raise ConfigError(f"--set {other}: sets options of the texture method, such as texture.segments=8; edit {file}")
    if maps := [picture for picture in pictures if file_kind(picture) == "heights"]:
        raise ConfigError(f"{maps[0]}: is a map of heights, which are felt as they are; parts are those of a picture")
    template = starter(pictures, file)
    setting = f"texture={{use: {on_one_line(method)}}}" if method else f"texture.segments={segments_for(most)}"
    config = parse_config(template.text, file, registry, [setting, *overrides])
    return Pipeline.from_config(config.with_values(scene=template.scene), registry, cache)


def proposed_heights(pipeline: Pipeline, parts: PartMap, top_m: float | None = None) -> PartHeights:
    """Find the heights of parts, rounded down, metres: by depth where the scene has it, else by a guess."""
    scene, choice = pipeline.scene, HeightChoice(by="guess")
    if top_m is None:
        top_m = RELIEF_MM / 1000 - choice.bulge_m - choice.detail_m
    two_views = scene.views is not None and scene.views.right is not None and pipeline.config.depth is not None
    disparity = pipeline.make("disparity") if scene.disparity is not None or two_views else None
    by_depth = choice.model_copy(update={"by": "depth"})
    by, picture = choice if disparity is None else by_depth, scene.views.left if scene.views else None
    proposal = choose_heights(parts, by, top_m, {}, disparity, scene.shown, picture)
    front = _figure(pipeline).front_parts(parts) if disparity is None else ()
    share, lift_m = (GROUND, GROUND * top_m) if front else (1.0, 0.0)
    heights = (share * height_m + lift_m * (number in front) for number, height_m in enumerate(proposal.heights_m))
    in_steps = (floor(height_m * STEPS_PER_M + 1e-6) / STEPS_PER_M for height_m in heights)
    return PartHeights(tuple(in_steps), proposal.reasons)


@contextmanager
def _observers_notified(registry: Registry) -> Generator[None]:
    """Notify plugins that parts are made, which takes seconds for a large picture."""
    hooks.tell(registry.plugins, "tangible_stage_started", product="parts", method="core")
    start, became = perf_counter(), "failed"
    try:
        yield
        became = "ran"
    finally:
        outcome = Outcome("parts", became, "requested", "core", perf_counter() - start)
        hooks.tell(registry.plugins, "tangible_stage_finished", outcome=outcome)
