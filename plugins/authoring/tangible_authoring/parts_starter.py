"""The commented pipeline file for a picture in parts, with a line for each part: its place and its height."""

import os
import re
from collections.abc import Sequence
from importlib.resources import files
from pathlib import Path
from string import Template

from tangible_core.data import name_part, shown_number
from tangible_core.files import plain_line
from tangible_core.files.yaml import on_one_line, part_lines
from tangible_core.parts import HeightChoice
from tangible_core.pipeline import SIDE_MM, Pipeline
from tangible_core.scene import Scene, SceneFiles, builtin_files

from .listed_parts import ListedPart

RELIEF_MM = 6.0
"""The height of the whole relief, mm: as `workspace` has it for parts."""
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
        "name": plain_line(Path(scene.name).name), "file": plain_line(str(file)), "columns": columns, "rows": rows,
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
    """Write a line for each part, with its number and place, which stay true when the height changes."""
    parts = {
        shown_number(part.number): {"name": part.name, "height_m": f"{1000 * (part.height_m or 0):.1f} mm"}
        for part in rows_of_parts
    }
    comments = {shown_number(part.number): f"{name_part(part.number)}: {part.where}" for part in rows_of_parts}
    return part_lines(parts, comments).removesuffix("\n")


def _scene_in_yaml(scene: Scene, folder: Path, labels: str) -> str:
    """Write the scene's files, with the label picture, relative to this folder."""
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
    """Return a path relative to this folder, so that both can be moved together."""
    here, there = path.absolute(), folder.absolute()
    if here.is_relative_to(there):
        return here.relative_to(there).as_posix()
    try:
        return Path(os.path.relpath(path.resolve(), folder.resolve())).as_posix()
    except ValueError:  # on another drive
        return here.as_posix()
