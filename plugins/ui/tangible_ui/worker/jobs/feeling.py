"""Jobs about force: a beacon, several force laws on one surface, and a study of two of them."""

import shlex
from datetime import datetime
from importlib.resources import files
from pathlib import Path
from string import Template
from typing import Any, cast

from tangible_core.data import HapticSurface
from tangible_core.errors import ConfigError, quoted
from tangible_core.files import write_text
from tangible_core.files.yaml import json_in_yaml, parse_value, plain
from tangible_core.pipeline import Pipeline
from tangible_core.pipeline.config import parse_config, relocate_text
from tangible_core.pipeline.engine import product_at_hand
from tangible_core.servo import beacon_to, parcel

from ...user_data import user_folder
from ..state import WorkerState
from .making import make_loop_input
from .table import job


@job(quick=True)
def beacon(state: WorkerState, text: str, path: Path, sets: list[str], part: int) -> dict[str, Any]:
    """Pack a beacon to a part of the document's surface, by number. Raises: ConfigError without a surface."""
    surface: HapticSurface | None = product_at_hand(state.make_pipeline(text, path, sets).engine, "surface")
    if surface is None:
        raise ConfigError("the surface of this document is not made yet; make it, and a beacon leads to its parts")
    new_beacon = beacon_to(surface, part)
    return {"part": new_beacon.part, "name": new_beacon.name, "parcel": str(parcel.pack(new_beacon))}


@job(page=True)
def law_names(state: WorkerState) -> list[str]:
    """List the installed force laws."""
    return sorted(state.registry.names("render"))


@job(quick=True)
def law_block(state: WorkerState, use: str, options: str) -> dict[str, Any]:
    """Return a law as `render:` has it. options: YAML, such as {stiffness_n_per_m: 500}. Raises: ConfigError."""
    try:
        values = plain(parse_value(options)) if options.strip() else {}
    except Exception as error:
        raise ConfigError(f"{quoted(options)} is not YAML; write options as {{stiffness_n_per_m: 500}}") from error
    if not isinstance(values, dict):
        raise ConfigError(f"{quoted(options)}: write options as {{stiffness_n_per_m: 500}}")
    return {"use": use, **cast("dict[str, Any]", values)}


@job()
def laws(
    state: WorkerState, text: str, path: Path, sets: list[str], others: list[dict[str, Any]]
) -> list[dict[str, Any]]:
    """Return the loop's input for the document's law, then for others as `render:` has them. Raises: ConfigError."""
    first = state.make_pipeline(text, path, sets)
    if first.config.render is None:
        raise first.config.missing("render")
    with_others = [state.read_config(text, path, [*sets, f"render={json_in_yaml(other)}"]) for other in others]
    return [
        make_loop_input(first),
        *(make_loop_input(Pipeline.from_config(config, like=first)) for config in with_others),
    ]


@job(quick=True)
def write_law_study(
    state: WorkerState,
    text: str,
    path: Path,
    sets: list[str],
    other: dict[str, Any],
    names: tuple[str, str],
    question: str,
    language: str,
) -> dict[str, str]:
    """Write a study of the document's law and another one; return its `file`, and the lines to `run`, `analyse`."""
    folder = user_folder("studies") / f"{datetime.now():%Y-%m-%d-%H.%M.%S}"
    file, pipeline, results = folder / "study.yaml", folder / "pipeline.yaml", folder / "results"
    run = ["tangible", "study", "run", str(file), "--page", "--participant", "P1", "--out", str(results)]
    paths = {
        "file": str(file),
        "run": shlex.join(run),
        "analyse": shlex.join(["tangible", "study", "analyse", str(results)]),
    }
    first, second = map(json_in_yaml, names)
    blocks = {"title": json_in_yaml(" / ".join(names)), "other": json_in_yaml(other), "first": first, "second": second}
    config = parse_config(text, path, state.registry, sets)
    write_text(pipeline, relocate_text(text, path, config, pipeline), private=True)
    study = Template(files("tangible_ui.worker.jobs").joinpath("law_study.yaml").read_text(encoding="utf-8"))
    study_text = study.substitute(paths, **blocks, question=question, language=language)
    write_text(file, study_text, private=True)
    return paths
