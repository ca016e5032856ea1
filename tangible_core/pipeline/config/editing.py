"""Changes to a pipeline file, key by key, that keep its comments and its order."""

import os
from collections.abc import Iterable, Mapping
from math import isfinite
from pathlib import Path
from typing import Any, cast

from pydantic import BaseModel

from ...data.quantities import with_units
from ...errors import ConfigError, quoted
from ...files.paths import as_path
from ...files.yaml.editing import REMOVE, Changes, change_text
from ...files.yaml.source import Location, find_key, parse_override, parse_source, plain
from .keys import MethodBlock, MethodList
from .keys.kinds import find_or_add
from .model import KEYS, PipelineConfig
from .parsing import EXPECTED, shorthand
from .scene_readers import find_scene_reader

__all__ = ["REMOVE", "Changes", "edit_text", "read_values", "relocate_text", "with_overrides"]


def edit_text(text: str, path: Path, changes: Changes) -> str:
    """Return a pipeline file's text with other values of these keys; comments elsewhere, and the order, stay.

    A number that was written with a unit is written with that unit again, and a new one with a unit. Another
    `depth.use` clears the options of the method before. A stage that is None is removed, as with `REMOVE`. The key
    `export.NAME.key` is an option of the exporter of that name, which is listed if it is not yet.
    path: the name in complaints. Nothing is checked but that it is YAML: see `parse_config`.
    Raises: ConfigError if the text is not YAML, or a key leads into a list; ArgumentError for values that JSON has not.
    """
    stages = {key for key in changes if isinstance(KEYS.get(".".join(map(str, split_key(key)))), MethodBlock)}
    changes = {key: REMOVE if value is None and key in stages else value for key, value in changes.items()}
    tree: Any = plain(parse_source(text, path, EXPECTED, empty=True).tree)
    places = {key: split_key(key) for key in changes}
    changes = {
        key: with_units(value, "".join(map(str, places[key][-1:])), _at(tree, places[key]))
        for key, value in changes.items()
    }
    within = {key: value for key, value in changes.items() if _is_within_list(key)}
    text = change_text(text, path, {key: value for key, value in changes.items() if key not in within}, shorthand)
    for key, value in within.items():
        parts = split_key(key)
        text = change_text(text, path, {parts[:1]: _list_with(text, path, parts, value)})
    return text


def _at(node: Any, parts: Location) -> Any:
    """Return the value at a key; None if there is none."""
    for part in parts:
        block: dict[Any, Any] = cast("dict[Any, Any]", node) if isinstance(node, dict) else {}
        node = block.get(find_key(part, block))
    return node


def split_key(key: str | Location) -> Location:
    return tuple(key.split(".")) if isinstance(key, str) else tuple(key)


def _is_within_list(key: str | Location) -> bool:
    """Return True for an option of a method in a list, such as `export.swell.page`."""
    parts = split_key(key)
    return len(parts) > 2 and isinstance(KEYS.get(parts[0]), MethodList)


def _list_with(text: str, path: Path, parts: Location, value: Any) -> list[Any]:
    """Return the whole list of methods with another value of one option."""
    entries = plain(parse_source(text, path, "it is a mapping", empty=True).tree.get(parts[0]) or [])
    if not isinstance(entries, list):
        raise ConfigError(f"{path}: {parts[0]}: takes a list of methods, not {quoted(entries)}")
    methods = cast("list[Any]", entries)
    index, keys = find_or_add(methods, str(parts[1])), parts[2:]
    block = methods[index] = {"use": methods[index]} if isinstance(methods[index], str) else dict(methods[index])
    if keys == ("use",) and block.get("use") != value:
        block.clear()
    for key in keys[:-1]:
        block = block.setdefault(key, {})
    if value is REMOVE:
        block.pop(keys[-1], None)
    else:
        block[keys[-1]] = value
    return methods


def with_overrides(text: str, path: Path, overrides: Iterable[str]) -> str:
    """Return the text with these overrides, `key.key=value` as `--set` takes them. Raises: ConfigError as `edited`."""
    for override in overrides:
        parts, value = parse_override(override)
        text = edit_text(text, path, {parts: plain(value)})
    return text


def read_values(text: str, path: Path) -> dict[str, Any]:
    """Read a pipeline file as plain values that JSON has, whether they are right or wrong."""
    source = parse_source(text, path, EXPECTED, empty=True)
    return _as_json(plain(source.tree))


def _as_json(node: Any) -> Any:
    """Return a value for JSON, whose keys are words; NaN and infinity become words."""
    if isinstance(node, dict):
        return {str(key): _as_json(value) for key, value in cast("dict[Any, Any]", node).items()}
    if isinstance(node, list):
        return [_as_json(value) for value in cast("list[Any]", node)]
    if node is None or isinstance(node, bool | int | str):
        return node
    return node if isinstance(node, float) and isfinite(node) else str(node)


def relocate_text(text: str, path: Path, config: PipelineConfig, out: Path) -> str:
    """Return a pipeline file's text for another place, from which its relative paths lead to the same files."""
    if out.parent.absolute() == path.parent.absolute():
        return text
    blocks = {place: model for name, key in KEYS.items() for place, model in key.models(getattr(config, name)).items()}
    tree, folder = read_values(text, path), out.parent.resolve()
    return edit_text(
        text, path, {**dict(_lead_elsewhere(tree, blocks, folder)), **_scene_elsewhere(tree, path, folder)}
    )


def _scene_elsewhere(tree: Mapping[str, Any], path: Path, folder: Path) -> Mapping[tuple[str, str], str]:
    """Return the relative paths of a scene reader's block, defaults included, from this folder."""
    block = tree.get("scene")
    if (reader := find_scene_reader(block)) is None:
        return {}
    paths = {name: value for name, value in reader.model_validate(block) if isinstance(value, Path)}
    there = path.parent.resolve()
    relative = {name: value for name, value in paths.items() if not as_path(value).is_absolute()}
    return {("scene", name): os.path.relpath(there / value, folder) for name, value in relative.items()}


def _lead_elsewhere(
    tree: Mapping[str, Any], blocks: Mapping[Location, Any], folder: Path
) -> Iterable[tuple[Location, str]]:
    """Find the keys of relative paths, and these paths from another folder."""
    for key, model in blocks.items():
        block: Any = tree
        for part in key:
            block = cast(Any, block).get(part) if isinstance(block, dict) else block[part]
        for name, value in model if isinstance(model, BaseModel) and isinstance(block, dict) else ():
            text = cast("dict[str, Any]", block).get(name)
            if isinstance(value, Path) and isinstance(text, str) and not Path(text).is_absolute():
                yield (*key, name), os.path.relpath(value.parent.resolve() / value.name, folder)
