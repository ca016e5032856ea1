"""The parts of a picture, as a list that a person reads beside the picture with their numbers."""

from collections.abc import Mapping
from typing import NamedTuple

from tangible_core.data import PartMap
from tangible_core.errors import ConfigError
from tangible_core.parts import PartChoice, PartHeights, part_sizes
from tangible_core.parts.words.places import place_in_words
from tangible_core.pipeline.config.material_choice import MaterialChoice
from tangible_core.pipeline.config.model import PipelineConfig
from tangible_core.pipeline.engine.part_heights import heights_of
from tangible_core.pipeline.engine.part_validation import check_found, parts_of
from tangible_core.pipeline.pipeline import Pipeline
from tangible_report.numbered_parts import numbered_parts

MOST_CELLS = 512
"""A side: where a part lies shows on so many."""


class ListedPart(NamedTuple):
    """What there is to say of one part."""

    number: int
    name: str
    """Empty where nobody gave it one."""
    place: str
    """Where it lies, in words; empty where that is on no side."""
    share: float
    """Of the picture."""
    height_m: float | None
    """None where the relief is not made of parts."""
    why: str
    """Where the height comes from."""
    material: str
    """What is said of it; empty where its material comes by a rule."""

    @property
    def where(self) -> str:
        """Its place and its share of the picture, in words."""
        share = f"{max(0.1, 100 * self.share):.{0 if self.share >= 0.01 else 1}f} % of the picture"
        return f"{self.place}, {share}" if self.place else share


class ListedParts(NamedTuple):
    """The parts of a pipeline's picture, and what is wrong with what the pipeline says of them."""

    found: PartMap
    parts: tuple[ListedPart, ...]
    numbered: bytes
    """The picture with their borders, numbers and names, as PNG."""
    scene_name: str
    wrong: ConfigError | None
    """What the pipeline says of parts that there are not, or that cannot be so high."""


def listed(parts: PartMap, heights: PartHeights | None, said: Mapping[int, PartChoice]) -> tuple[ListedPart, ...]:
    """Every part with what is said of it. heights: None where the relief is not made of parts."""
    step = -(-max(parts.labels.shape) // MOST_CELLS)
    shown, sizes = parts.labels[::step, ::step], part_sizes(parts)

    def one(number: int) -> ListedPart:
        choice, there = said.get(number, PartChoice()), shown == number
        return ListedPart(
            number,
            choice.name.strip(),
            place_in_words(there if there.any() else parts.labels == number),
            float(sizes[number] / parts.labels.size),
            None if heights is None else heights.heights_m[number],
            "" if heights is None else heights.reasons[number],
            choice.material or "",
        )

    return tuple(map(one, range(parts.count)))


def list_parts(pipeline: Pipeline) -> ListedParts:
    """The parts of this pipeline's picture, also where what it says of parts is wrong.

    Raises: ConfigError for a scene without segments, PictureError for more than can be felt; TangibleError as
    `Pipeline.make`.
    """
    config, scene = pipeline.config, pipeline.scene
    alone = pipeline.changed(config.changed(parts=None, heights=None, materials=MaterialChoice()))
    segments = alone.make("segments")
    if segments is None or scene.views is None:
        where = f"{config.path}: " if config.path else ""
        raise ConfigError(
            f"{where}the scene has no parts; give it a picture with `segments: parts.png`, or a `texture:` method"
        )
    parts, said = parts_of(segments), config.parts or {}
    heights = None
    if config.heights is not None:
        given_m = {number: height_m for number, height_m in config.given_heights_m.items() if number < parts.count}
        disparity = alone.make("disparity") if config.heights.by == "depth" else None
        heights = heights_of(parts, config.heights, config.top_m, given_m, disparity, scene.shown)
    found = listed(parts, heights, said)
    names = [each.name for each in found]
    numbered = numbered_parts(scene.views.left, parts, names)
    return ListedParts(parts, found, numbered, scene.name, _wrong(config, parts))


def _wrong(config: PipelineConfig, parts: PartMap) -> ConfigError | None:
    try:
        check_found(config, parts, parts.labels.shape[1])
    except ConfigError as error:
        return error
    return None
