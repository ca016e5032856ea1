"""The parts of a picture, as a list that a person reads beside the picture with their numbers."""

from collections.abc import Mapping
from typing import NamedTuple

from tangible_core.data import PartMap
from tangible_core.errors import ConfigError
from tangible_core.parts import PartChoice, PartHeights, part_sizes
from tangible_core.pipeline import Pipeline
from tangible_core.pipeline.config import MaterialChoice, PipelineConfig
from tangible_core.pipeline.engine import check_parts, heights_of, parts_of
from tangible_legibility.words.places import place_in_words
from tangible_report.numbered_parts import numbered_parts

MAX_CELLS = 512
"""The most cells of a map's side that the place of a part is found on: more show no other place."""


class ListedPart(NamedTuple):
    """A row of the list: one part."""

    number: int
    name: str
    """The name; empty for a part without one."""
    place: str
    """The place in the picture, in words; empty for a part that lies on no side."""
    share: float
    """The share of the picture's pixels, 0 to 1."""
    height_m: float | None
    """The height, metres; None where the relief is not made of parts."""
    why: str
    """The source of the height."""
    material: str
    """The material of the file; empty where a rule decides."""

    @property
    def where(self) -> str:
        """The place and the share of the picture, in words."""
        share = f"{max(0.1, 100 * self.share):.{0 if self.share >= 0.01 else 1}f} % of the picture"
        return f"{self.place}, {share}" if self.place else share


class ListedParts(NamedTuple):
    """The parts of a pipeline's picture, and the mistakes in its `parts:`."""

    part_map: PartMap
    parts: tuple[ListedPart, ...]
    numbers_png: bytes
    """The picture with their borders, numbers and names, as PNG."""
    scene_name: str
    wrong: ConfigError | None
    """Complaints about parts that do not exist, or that cannot be so high."""


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
    parts = parts_of(segments)
    heights = None
    if config.heights is not None:
        given_m = {number: height_m for number, height_m in config.given_heights_m.items() if number < parts.count}
        disparity = alone.make("disparity") if config.heights.by == "depth" else None
        picture = scene.views.left
        heights = heights_of(parts, config.heights, config.top_m, given_m, disparity, scene.shown, picture)
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
