"""A pipeline file that is edited key by key, with its own comments and in its own order."""

import os
from collections.abc import Iterable, Mapping
from math import isfinite
from pathlib import Path
from typing import Any, cast

from pydantic import BaseModel

from ...errors import ConfigError, quoted
from ...files.editing import REMOVE, Changes, change_text
from ...files.paths import as_path
from ...files.source import Location, parse_override, parse_source, plain
from .config import STAGES, PipelineConfig, exporter_at, shorthand
from .scene_readers import scene_reader_of

__all__ = ["REMOVE", "Changes", "edited", "moved", "said", "with_overrides"]


def edited(text: str, path: Path, changes: Changes) -> str:
    """A pipeline file's text in which these keys say that; comments elsewhere, and the order, stay.

    Another `depth.use` clears the options of the method before. A stage that is None goes, as with `REMOVE`. The key
    `export.NAME.key` is of the exporter of that name, which is listed if it is not yet.
    path: what complaints name. Nothing is checked but that it is YAML: see `parse_config`.
    Raises: ConfigError if the text is no YAML, or a key leads into a list; ArgumentError for what JSON cannot say.
    """
    changes = {key: REMOVE if value is None and _is_stage(key) else value for key, value in changes.items()}
    within = {key: value for key, value in changes.items() if _is_within_exporter(key)}
    text = change_text(text, path, {key: value for key, value in changes.items() if key not in within}, shorthand)
    for key, value in within.items():
        text = change_text(text, path, {("export",): _exporters_with(text, path, _parts_of(key), value)})
    return text


def _parts_of(key: str | Location) -> Location:
    return tuple(key.split(".")) if isinstance(key, str) else tuple(key)


def _is_within_exporter(key: str | Location) -> bool:
    parts = _parts_of(key)
    return len(parts) > 2 and parts[0] == "export"


def _exporters_with(text: str, path: Path, parts: Location, value: Any) -> list[Any]:
    """The whole list of exporters in which an option of one says that."""
    listed = plain(parse_source(text, path, "it is a mapping", empty=True).tree.get("export") or [])
    if not isinstance(listed, list):
        raise ConfigError(f"{path}: export: takes a list of exporters, not {quoted(listed)}")
    found = cast("list[Any]", listed)
    index, keys = exporter_at(found, str(parts[1])), parts[2:]
    block = found[index] = {"use": found[index]} if isinstance(found[index], str) else dict(found[index])
    if keys == ("use",) and block.get("use") != value:
        block.clear()
    for key in keys[:-1]:
        block = block.setdefault(key, {})
    if value is REMOVE:
        block.pop(keys[-1], None)
    else:
        block[keys[-1]] = value
    return found


def _is_stage(key: Any) -> bool:
    return ".".join(map(str, _parts_of(key))) in STAGES


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
    methods = {(kind,): chosen.method for kind in STAGES if (chosen := getattr(config, kind))}
    exporters = {("export", index): each.method for index, each in enumerate(config.export)}
    blocks = {("scene",): config.scene, ("materials",): config.materials, **methods, **exporters}
    tree, folder = said(text, path), out.parent.resolve()
    return edited(text, path, {**dict(_lead_elsewhere(tree, blocks, folder)), **_scene_elsewhere(tree, path, folder)})


def _scene_elsewhere(tree: Mapping[str, Any], path: Path, folder: Path) -> Mapping[tuple[str, str], str]:
    """Return the relative paths of a scene reader's block, defaults included, from this folder."""
    block = tree.get("scene")
    if (reader := scene_reader_of(block)) is None:
        return {}
    paths = {name: value for name, value in reader.model_validate(block) if isinstance(value, Path)}
    there = path.parent.resolve()
    relative = {name: value for name, value in paths.items() if not as_path(value).is_absolute()}
    return {("scene", name): os.path.relpath(there / value, folder) for name, value in relative.items()}


def _lead_elsewhere(
    tree: Mapping[str, Any], blocks: Mapping[Location, Any], folder: Path
) -> Iterable[tuple[Location, str]]:
    """Keys of relative paths, and what they are from this folder."""
    for key, model in blocks.items():
        block: Any = tree
        for part in key:
            block = cast(Any, block).get(part) if isinstance(block, dict) else block[part]
        for name, value in model if isinstance(model, BaseModel) and isinstance(block, dict) else ():
            written = cast("dict[str, Any]", block).get(name)
            if isinstance(value, Path) and isinstance(written, str) and not Path(written).is_absolute():
                yield (*key, name), os.path.relpath(value.parent.resolve() / value.name, folder)
