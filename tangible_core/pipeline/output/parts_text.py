"""The parts with their computed heights, as a pipeline file to correct."""

from pathlib import Path
from typing import Any

from ...data import DisparityMap, PartMap
from ...data.part_words import name_part, shown_number
from ...data.quantities import with_units
from ...errors import ConfigError, shown
from ...files.yaml.editing import on_one_line
from ...files.yaml.parts_block import with_parts
from ...parts import PartChoice, PartHeights
from ..config.model import PipelineConfig
from ..engine.engine import Engine
from ..engine.stage import Context
from ..engine.stages.relief import ReliefStage

MAX_REASON = 300
SOURCES = {
    "guess": "The heights are guessed: a picture does not show which parts are in front.",
    "depth": "The heights are by depth: each is the median over its part.",
    "given": "The heights are as they were given; parts without one lie at 0.",
}
"""The first sentence of the file, by the source of the heights."""


def part_heights(engine: Engine) -> PartHeights | None:
    """Return the height of each part in the relief, with its reason; None for a relief that is not made of parts."""
    config = engine.config
    if config.heights is None:
        return None
    parts: PartMap = engine.make_on_grid(config.felt_parts)
    disparity: DisparityMap | None = engine.make_on_grid("disparity") if config.heights.by == "depth" else None
    return ReliefStage(Context(config, engine.scene)).part_heights(parts, disparity)


def to_correct(engine: Engine) -> str:
    """Write a pipeline file with the present height of every part, to be corrected; it runs as it is."""
    config, heights = engine.config, part_heights(engine)
    if config.heights is None or heights is None:
        raise ConfigError("no part has a height: the relief is not made of parts; choose how: heights={'by': ...}")
    try:
        rest = config.as_yaml(leave_out=("parts", "heights"))
    except ConfigError:
        rest = ""
    head = f"# {SOURCES[config.heights.by]} Correct what is wrong, and give names.\n"
    recipe = config.heights.model_copy(update={"by": "given"}).model_dump(mode="json")
    reasons = {n: f"{name_part(n - 1)}: {shown(why, MAX_REASON)}" for n, why in enumerate(heights.reasons, 1)}
    parts = with_parts(rest, Path(), with_units(_blocks(config, heights)), reasons)
    return f"{head}{parts}heights: {on_one_line(recipe)}\n"


def _blocks(config: PipelineConfig, heights: PartHeights) -> dict[int, dict[str, Any]]:
    choices = {label: config.choices.get(label, PartChoice()) for label in range(len(heights.heights_m))}
    return {
        shown_number(label): {
            "name": choice.name.strip(),
            "height_m": heights.heights_m[label],
            **({} if choice.material is None else {"material": choice.material}),
        }
        for label, choice in choices.items()
    }
