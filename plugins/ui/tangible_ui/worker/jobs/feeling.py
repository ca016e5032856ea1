"""Jobs that prepare input of the force loop: a beacon, and several force laws on one surface."""

from pathlib import Path
from typing import Any, cast

from tangible_core.data import HapticSurface
from tangible_core.errors import ConfigError, quoted
from tangible_core.files.yaml.editing import json_in_yaml
from tangible_core.files.yaml.source import parse_value, plain
from tangible_core.pipeline.pipeline import Pipeline
from tangible_core.servo import beacon_to, parcel

from ..loop_input import loop_input_of
from ..state import WorkerState
from ..view.surface_view import at_hand
from .table import job


@job(quick=True)
def beacon(state: WorkerState, text: str, path: Path, sets: list[str], part: int) -> dict[str, Any]:
    """Pack a beacon to a part of the document's surface, by number. Raises: ConfigError without a surface."""
    surface: HapticSurface | None = at_hand(state.pipeline_of(text, path, sets), "surface")
    if surface is None:
        raise ConfigError("the surface of this document is not made yet; make it, and a beacon leads to its parts")
    made = beacon_to(surface, part)
    return {"part": made.part, "name": made.name, "parcel": str(parcel.pack(made))}


@job(page=True)
def law_names(state: WorkerState) -> list[str]:
    """List the installed force laws."""
    return sorted(state.registry.names("render"))


@job(quick=True)
def law_block(state: WorkerState, use: str, options: str) -> dict[str, Any]:
    """Return a law as `render:` has it. options: YAML, such as {stiffness_n_per_m: 500}. Raises: ConfigError."""
    try:
        said = plain(parse_value(options)) if options.strip() else {}
    except Exception as error:
        raise ConfigError(f"{quoted(options)} is not YAML; write options as {{stiffness_n_per_m: 500}}") from error
    if not isinstance(said, dict):
        raise ConfigError(f"{quoted(options)}: write options as {{stiffness_n_per_m: 500}}")
    return {"use": use, **cast("dict[str, Any]", said)}


@job()
def laws(
    state: WorkerState, text: str, path: Path, sets: list[str], others: list[dict[str, Any]]
) -> list[dict[str, Any]]:
    """Return the loop's input for the document's law, then for others, which are blocks as `render:` has them.

    Raises: ConfigError if the document has no law, or a block is wrong; TangibleError as `Pipeline.make`.
    """
    first = state.pipeline_of(text, path, sets)
    if first.config.render is None:
        raise first.config.missing("render")
    with_others = [state.config_of(text, path, [*sets, f"render={json_in_yaml(each)}"]) for each in others]
    return [loop_input_of(first), *(loop_input_of(Pipeline.from_config(config, like=first)) for config in with_others)]
