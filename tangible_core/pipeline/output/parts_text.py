"""The parts and their heights as they were found, as a pipeline file to correct."""

from pathlib import Path
from typing import Any

from ...data import DisparityMap, PartMap
from ...errors import ConfigError, shown
from ...files.yaml.editing import on_one_line
from ...files.yaml.parts_block import with_parts
from ...parts import PartChoice, PartHeights
from ..config.model import PipelineConfig
from ..engine.engine import Engine
from ..engine.stage import Context
from ..engine.stages.relief import ReliefStage

MOST_REASON = 300
"""Characters of what is said behind a part."""
SOURCES = {
    "guess": "The heights are guessed: a picture does not tell what stands in front of what.",
    "depth": "The heights are by depth: each is the median over its part.",
    "given": "The heights are as they were given; what had none lies at 0.",
}


def part_heights(engine: Engine) -> PartHeights | None:
    """The height of each part, and why, as the relief has them; None where it is not made of parts.

    Raises: TangibleError as `Engine.make`.
    """
    config = engine.config
    if config.heights is None:
        return None
    found: PartMap = engine.make_on_grid(config.felt_parts)
    disparity: DisparityMap | None = engine.make_on_grid("disparity") if config.heights.by == "depth" else None
    return ReliefStage(Context(config, engine.scene)).part_heights(found, disparity)


def to_correct(engine: Engine) -> str:
    """A pipeline file in which every part has the height that it has now, to be corrected; it runs as it stands.

    Where no file can say the rest, as of a scene of arrays, only the parts and `heights:`.
    Raises: ConfigError where the relief is not made of parts; TangibleError as `Engine.make`.
    """
    config, heights = engine.config, part_heights(engine)
    if config.heights is None or heights is None:
        raise ConfigError("no part has a height: the relief is not made of parts; say how it is: heights={'by': ...}")
    try:
        rest = config.as_yaml(leave_out=("parts", "heights"))
    except ConfigError:
        rest = ""
    head = f"# {SOURCES[config.heights.by]} Correct what is wrong, and give names.\n"
    given = config.heights.model_copy(update={"by": "given"}).model_dump(mode="json")
    reasons = {number: shown(why, MOST_REASON) for number, why in enumerate(heights.reasons)}
    parts = with_parts(rest, Path(), _corrected(config, heights), reasons)
    return f"{head}{parts}heights: {on_one_line(given)}\n"


def _corrected(config: PipelineConfig, heights: PartHeights) -> dict[int, dict[str, Any]]:
    """Return the block of each part, with the height that it has now."""
    choices = {number: (config.parts or {}).get(number, PartChoice()) for number in range(len(heights.heights_m))}
    return {
        number: {
            "name": choice.name.strip(),
            "height_m": heights.heights_m[number],
            **({} if choice.material is None else {"material": choice.material}),
        }
        for number, choice in choices.items()
    }
