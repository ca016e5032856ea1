"""The parts of a picture: a list to read beside their numbers, and a commented pipeline file with a line for each."""

import os
import re
from collections.abc import Mapping, Sequence
from importlib.resources import files
from pathlib import Path
from string import Template
from typing import NamedTuple

from tangible_core.data import PartMap, name_part, shown_number
from tangible_core.errors import ConfigError
from tangible_core.files import plain_line
from tangible_core.files.yaml import on_one_line, part_lines
from tangible_core.parts import HeightChoice, PartChoice, PartHeights, part_sizes
from tangible_core.pipeline import SIDE_MM, Pipeline
from tangible_core.pipeline.config import MaterialChoice, PipelineConfig
from tangible_core.pipeline.engine import check_parts, choose_heights, divide_segments
from tangible_core.scene import Scene, SceneFiles, builtin_files
from tangible_legibility.words.places import place_in_words
from tangible_report.numbered_parts import numbered_parts

MAX_CELLS = 512  # of a side on which a part's place is found: more show no other place


class ListedPart(NamedTuple):
    """A row of the list: one part."""

    number: int
    name: str  # empty for a part without one
    place: str  # in words; empty for a part that lies on no side
    share: float  # of the picture's pixels, 0 to 1
    height_m: float | None  # None where the relief is not made of parts
    why: str  # the source of the height
    material: str  # empty where a rule decides

    @property
    def where(self) -> str:
        """The place and the share of the picture, in words."""
        share = f"{max(0.1, 100 * self.share):.{0 if self.share >= 0.01 else 1}f} % of the picture"
        return f"{self.place}, {share}" if self.place else share


class ListedParts(NamedTuple):
    """The parts of a pipeline's picture, and the mistakes in its `parts:`."""

    part_map: PartMap
    parts: tuple[ListedPart, ...]
    numbers_png: bytes  # the picture with borders, numbers and names
    scene_name: str
    wrong: ConfigError | None  # parts that do not exist, or cannot be so high


def list_rows(parts: PartMap, heights: PartHeights | None, choices: Mapping[int, PartChoice]) -> tuple[ListedPart, ...]:
    """Make a row for every part. heights: of the parts, if they have some. choices: of the file, by label."""
    step = -(-max(parts.labels.shape) // MAX_CELLS)
    small, sizes = parts.labels[::step, ::step], part_sizes(parts)

    def row(number: int) -> ListedPart:
        choice, there = choices.get(number, PartChoice()), small == number
        return ListedPart(
            number,
            choice.name.strip(),
            place_in_words(there if there.any() else parts.labels == number),
            float(sizes[number] / parts.labels.size),
            None if heights is None else heights.heights_m[number],
            "" if heights is None else heights.reasons[number],
            choice.material or "",
        )

    return tuple(map(row, range(parts.count)))


def list_parts(pipeline: Pipeline) -> ListedParts:
    """List the parts of a pipeline's picture, even where its `parts:` is wrong. Raises: ConfigError, PictureError."""
    config, scene = pipeline.config, pipeline.scene
    alone = Pipeline.from_config(
        config.with_values(parts=None, heights=None, materials=MaterialChoice()), like=pipeline
    )
    segments = alone.make("segments")
    if segments is None or scene.views is None:
        where = f"{config.path}: " if config.path else ""
        raise ConfigError(
            f"{where}the scene has no parts; give it a picture with `segments: parts.png`, or a `texture:` method"
        )
    parts = divide_segments(segments)
    heights = None
    if config.heights is not None:
        given_m = {number: height_m for number, height_m in config.given_heights_m.items() if number < parts.count}
        disparity = alone.make("disparity") if config.heights.by == "depth" else None
        picture = scene.views.left
        heights = choose_heights(parts, config.heights, config.top_m, given_m, disparity, scene.shown, picture)
    rows = list_rows(parts, heights, config.choices)
    names = [row.name for row in rows]
    numbers_png = numbered_parts(scene.views.left, parts, names)
    return ListedParts(parts, rows, numbers_png, scene.name, _wrong(config, parts))


def _wrong(config: PipelineConfig, parts: PartMap) -> ConfigError | None:
    try:
        check_parts(config, parts, parts.labels.shape[1])
    except ConfigError as error:
        return error
    return None


RELIEF_MM = 6.0  # as `workspace` has it for parts
GUESSED = "`tangible parts` wrote a guess, as a picture does not show which parts are in front."
MEASURED = "`tangible parts` wrote the median of the depth over the part."


def parts_starter(
    pipeline: Pipeline, file: Path, labels: str, numbered: str, title: str, rows_of_parts: Sequence[ListedPart]
) -> str:
    """Write a pipeline file at `file` for these parts, with pictures of these names next to it."""
    scene, heights = pipeline.scene, HeightChoice(by="given")
    rows, columns = scene.shape
    longer = max(rows, columns)
    is_guess = all("guess" in part.why for part in rows_of_parts)
    depth = pipeline.config.depth
    values = {
        "name": plain_line(Path(scene.name).name), "columns": columns, "rows": rows,
        "count": f"{len(rows_of_parts)} part{'s' * (len(rows_of_parts) != 1)}",
        "labels": labels, "numbered": numbered, "scene": _scene_in_yaml(scene, file.parent, labels),
        "title": on_one_line(title), "heights": GUESSED if is_guess else MEASURED, "parts": _lines(rows_of_parts),
        "round_mm": f"{1000 * heights.round_m:g}", "bulge_mm": f"{1000 * heights.bulge_m:g}",
        "detail_mm": f"{1000 * heights.detail_m:g}", "relief_mm": f"{RELIEF_MM:g}",
        "width_mm": f"{SIDE_MM * columns / longer:.3g}",
        "depth": f"depth: {{use: {depth.name}}}" if depth and not is_guess else "",
    }  # fmt: skip
    text = files("tangible_core.pipeline").joinpath("starter_parts.yaml").read_text(encoding="utf-8")
    return re.sub(r"\n{3,}", "\n\n", Template(text).substitute(values))


def make_title(picture: Path) -> str:
    """Make a title of the name of a file: words, the first letter large.

    >>> make_title(Path("old/girl_with-a pearl.jpg")), make_title(Path("IMG_2041.JPG"))
    ('Girl with a pearl', 'IMG 2041')
    """
    stem = plain_line(picture.stem)
    words = re.sub(r"[\s_-]+", " ", stem).strip() or stem
    return words[:1].upper() + words[1:]


def _lines(rows_of_parts: Sequence[ListedPart]) -> str:
    parts = {
        shown_number(part.number): {"name": part.name, "height_m": f"{1000 * (part.height_m or 0):.1f} mm"}
        for part in rows_of_parts
    }
    comments = {shown_number(part.number): f"{name_part(part.number)}: {part.where}" for part in rows_of_parts}
    return part_lines(parts, comments).removesuffix("\n")


def _scene_in_yaml(scene: Scene, folder: Path, labels: str) -> str:
    is_builtin = isinstance(scene.files, str)  # a builtin scene's files never move with the pipeline file
    paths = builtin_files(scene.files) if isinstance(scene.files, str) else scene.files
    assert paths is not None
    defaults = {name: field.default for name, field in SceneFiles.model_fields.items()}
    fields = {name: value for name, value in paths if value != defaults[name]}
    texts = {
        name: _relative(value, folder) if isinstance(value, Path) and not is_builtin else f"{value}"
        for name, value in fields.items()
    }
    return on_one_line({**texts, "segments": labels})


def _relative(path: Path, folder: Path) -> str:
    here, there = path.absolute(), folder.absolute()
    if here.is_relative_to(there):
        return here.relative_to(there).as_posix()
    try:
        return Path(os.path.relpath(path.resolve(), folder.resolve())).as_posix()
    except ValueError:  # on another drive
        return here.as_posix()
