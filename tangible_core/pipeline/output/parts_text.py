"""The parts and their heights as they were found, as a pipeline file to correct."""

import json
from collections.abc import Iterator

from ...data import DisparityMap, PartMap
from ...errors import ConfigError, shown
from ...parts import PartChoice, PartHeights
from ..config.config import PipelineConfig
from ..engine import rules
from ..engine.engine import Engine
from ..engine.felt import FeltScene

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
    found: PartMap = engine.felt(config.felt_parts)
    disparity: DisparityMap | None = engine.felt("disparity") if config.heights.by == "depth" else None
    return rules.part_heights(config, FeltScene(engine.scene, config.size), found, disparity)


def to_correct(engine: Engine) -> str:
    """A pipeline file in which every part has the height that it has now, to be corrected; it runs as it stands.

    Where no file can say the rest, as of a scene of arrays, only the parts and `heights:`.
    Raises: ConfigError where the relief is not made of parts; TangibleError as `Engine.make`.
    """
    config, found = engine.config, part_heights(engine)
    if config.heights is None or found is None:
        raise ConfigError("no part has a height: the relief is not made of parts; say how it is: heights={'by': ...}")
    block = "\n".join(_lines(config, found))
    try:
        rest = config.as_yaml(leave_out=("parts", "heights"))
    except ConfigError:
        rest = ""
    head = f"# {SOURCES[config.heights.by]} Correct what is wrong, and give names.\n"
    return f"{head}{rest}{block}\n"


def _lines(config: PipelineConfig, found: PartHeights) -> Iterator[str]:
    assert config.heights is not None
    yield "parts:"
    for number, (height_m, why) in enumerate(zip(found.heights_m, found.reasons, strict=True)):
        choice = (config.parts or {}).get(number, PartChoice())
        said = {"name": choice.name.strip(), "height_m": height_m, "material": choice.material}
        told = ((key, json.dumps(value, ensure_ascii=False)) for key, value in said.items() if value is not None)
        words = ", ".join(f"{key}: {value}" for key, value in told)
        yield f"  {number}: {{{words}}}  # {shown(why, MOST_REASON)}"
    given = config.heights.model_copy(update={"by": "given"}).model_dump(mode="json")
    yield f"heights: {{{', '.join(f'{key}: {value}' for key, value in given.items())}}}"
