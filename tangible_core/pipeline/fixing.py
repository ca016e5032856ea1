"""What to change in a pipeline file for it to pass preflight: the cures, one at a time, each tried before the next."""

import os
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from io import StringIO
from pathlib import Path
from typing import Any, cast

from pydantic import BaseModel
from ruamel.yaml import YAML

from ..files.source import Source, parse_source, read_text
from ..preflight import Flight, Hand, Loop, Preflight, judge
from ..preflight.verdict import Change
from .config import STAGES, PipelineConfig, parse_config
from .pipeline import Pipeline

ROUNDS = 24
"""Most need one to three changes; each is tried on the surface that it makes."""
AT_ONCE = 0.001
"""Seconds for which a machine is timed again: what counts is how late it was in the first flight."""


@dataclass(frozen=True)
class Fixed:
    """What was changed, and what preflight says then."""

    changes: Mapping[str, str]
    """By key, in the order in which they were made."""
    flight: Flight
    verdicts: Preflight
    text: str
    """The file with these changes and with its own comments, as one that stands where it is to be written."""


def fix(path: Path, sets: Iterable[str], hand: Hand, loop: Loop, out: Path, cached: bool = True) -> Fixed:
    """Change what the cures say, the unsafe first, until nothing is left to change; `verdicts.safe` says if it passes.

    sets: `key.key=value` each, as `--set` takes them. out: where the file is to stand; nothing is written.
    Raises: ConfigError as `load_config`; TangibleError as `Pipeline.flight`.
    """
    text, made = read_text(path), list[str](sets)
    pipeline = Pipeline.from_yaml(path, made)
    if not cached:
        pipeline.cache = None
    first = flight = pipeline.flight(hand=hand, loop=loop)
    done: dict[str, Change] = {}
    for _ in range(ROUNDS):
        if (change := _next(judge(flight), done)) is None:
            break
        made += _overrides(change, pipeline.config, text, made)
        done[change.key] = change
        config = parse_config(text, path, pipeline.engine.registry, made)
        pipeline = pipeline.changed(config)
        flight = pipeline.flight(hand=hand, loop=replace(loop, seconds=AT_ONCE))
        flight = replace(flight, lateness=first.lateness)
    changes = {key: change.value for key, change in done.items()}
    return Fixed(changes, flight, judge(flight), _moved(text, path, made, pipeline, out))


def _next(verdicts: Preflight, done: Mapping[str, Change]) -> Change | None:
    """The first change of the worst verdict that brings anything new."""
    worst_first = sorted(verdicts, key=lambda each: each.verdict != "unsafe")
    return next((change for each in worst_first for change in each.changes[:1] if _is_new(change, done)), None)


def _is_new(change: Change, done: Mapping[str, Change]) -> bool:
    before = done.get(change.key)
    if before is None:
        return True
    return before.towards == change.towards != "is" and before.stricter(change).value != before.value


def _overrides(change: Change, config: PipelineConfig, text: str, made: Iterable[str]) -> Iterable[str]:
    """As `--set` takes it; a method that is named by a word alone becomes a block first."""
    block, _, _ = change.key.partition(".")
    tree = parse_source(text, Path("file"), "", made).tree
    if block in STAGES and isinstance(tree.get(block), str):
        yield f"{block}={{use: {tree[block]}}}"
    yield f"{change.key}={change.value}"


def _moved(text: str, path: Path, made: Iterable[str], pipeline: Pipeline, out: Path) -> str:
    """The file with what was changed, its relative paths leading to the same files from where it is to stand."""
    source = parse_source(text, path, "", made)
    if out.parent.absolute() != path.parent.absolute():
        config = pipeline.config
        methods = {kind: chosen.method for kind in STAGES if (chosen := getattr(config, kind))}
        for key, model in {"scene": config.scene, "materials": config.materials, **methods}.items():
            if isinstance(model, BaseModel):
                _lead_elsewhere(source, key, model, out.parent.resolve())
    written = StringIO()
    yaml: Any = YAML(typ="rt")
    yaml.width = 4096
    yaml.dump(source.tree, written)
    return written.getvalue()


def _lead_elsewhere(source: Source, key: str, model: BaseModel, folder: Path) -> None:
    block = source.tree.get(key)
    for name, value in model:
        said = cast("dict[str, Any]", block).get(name) if isinstance(block, dict) else None
        if isinstance(value, Path) and isinstance(said, str) and not Path(said).is_absolute():
            cast("dict[str, Any]", block)[name] = os.path.relpath(value.parent.resolve() / value.name, folder)
