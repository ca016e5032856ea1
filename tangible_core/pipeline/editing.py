"""A pipeline file that is edited key by key, with its own comments and in its own order."""

import os
from collections.abc import Iterable, Mapping
from math import isfinite
from pathlib import Path
from typing import Any, cast

from pydantic import BaseModel

from ..datasets.choosing import with_folder
from ..files.editing import REMOVE, Changes, change_text
from ..files.paths import as_path
from ..files.source import parse_override, parse_source, plain
from .config import STAGES, PipelineConfig, shorthand

__all__ = ["REMOVE", "Changes", "edited", "moved", "said", "with_overrides"]


def edited(text: str, path: Path, changes: Changes) -> str:
    """A pipeline file's text in which these keys say that; comments elsewhere, and the order, stay.

    Another `depth.use` clears the options of the method before. A stage that is None goes, as with `REMOVE`.
    path: what complaints name. Nothing is checked but that it is YAML: see `parse_config`.
    Raises: ConfigError if the text is no YAML, or a key leads into a list; ArgumentError for what JSON cannot say.
    """
    changes = {key: REMOVE if value is None and _is_stage(key) else value for key, value in changes.items()}
    return change_text(text, path, changes, shorthand)


def _is_stage(key: Any) -> bool:
    return (key if isinstance(key, str) else ".".join(map(str, key))) in STAGES


def with_overrides(text: str, path: Path, overrides: Iterable[str]) -> str:
    """The text with what `key.key=value` says, each as `--set` takes it. Raises: ConfigError as `edited`."""
    for each in overrides:
        parts, value = parse_override(each)
        text = edited(text, path, {parts: plain(value)})
    return text


def said(text: str, path: Path) -> dict[str, Any]:
    """What a pipeline file says, as plain values that JSON can say, whether it is right or wrong.

    Raises: ConfigError if it is no YAML, or no mapping.
    """
    source = parse_source(text, path, "a configuration is a mapping that starts with `scene:`", empty=True)
    return _as_json(plain(source.tree))


def _as_json(node: Any) -> Any:
    """Keys are words there, and what is no number is a word."""
    if isinstance(node, dict):
        return {str(key): _as_json(value) for key, value in cast("dict[Any, Any]", node).items()}
    if isinstance(node, list):
        return [_as_json(value) for value in cast("list[Any]", node)]
    if node is None or isinstance(node, bool | int | str):
        return node
    return node if isinstance(node, float) and isfinite(node) else str(node)


def moved(text: str, path: Path, config: PipelineConfig, out: Path) -> str:
    """A pipeline file's text as it reads where it is to stand: its relative paths lead to the same files from there.

    config: what the text says at `path`.
    """
    if out.parent.absolute() == path.parent.absolute():
        return text
    methods = {kind: chosen.method for kind in STAGES if (chosen := getattr(config, kind))}
    blocks = {"scene": config.scene, "materials": config.materials, **methods}
    tree, folder = said(text, path), out.parent.resolve()
    return edited(text, path, {**dict(_lead_elsewhere(tree, blocks, folder)), **_set_elsewhere(tree, path, folder)})


def _set_elsewhere(tree: Mapping[str, Any], path: Path, folder: Path) -> Mapping[tuple[str, str], str]:
    """Where a standard set lies, from this folder: one of its name beside the file if nothing was said."""
    scene = tree.get("scene")
    if not isinstance(scene, dict) or "set" not in scene:
        return {}
    lies = as_path(with_folder(scene)["folder"])
    there = path.parent.resolve() / lies
    return {} if lies.is_absolute() else {("scene", "folder"): os.path.relpath(there, folder)}


def _lead_elsewhere(
    tree: Mapping[str, Any], blocks: Mapping[str, Any], folder: Path
) -> Iterable[tuple[tuple[str, str], str]]:
    """Keys of relative paths, and what they are from this folder."""
    for key, model in blocks.items():
        block = tree.get(key)
        for name, value in model if isinstance(model, BaseModel) and isinstance(block, dict) else ():
            written = cast("dict[str, Any]", block).get(name)
            if isinstance(value, Path) and isinstance(written, str) and not Path(written).is_absolute():
                yield (key, name), os.path.relpath(value.parent.resolve() / value.name, folder)
