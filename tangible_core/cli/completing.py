"""Shell completion of unfinished words, quickly: names are read from metadata."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any, cast

from ..errors import TangibleError
from ..plugins.registry import KIND_NAMES, default_registry


def methods(ctx: Any, incomplete: str) -> list[tuple[str, str]]:
    """Return the methods of the kind that was typed before, with their summaries."""
    return _installed_methods(ctx.params.get("kind"), incomplete)


def devices(incomplete: str) -> list[tuple[str, str]]:
    """Return the devices, with their summaries."""
    return _installed_methods("device", incomplete)


def exporters(incomplete: str) -> list[tuple[str, str]]:
    """Return the exporters, with their summaries; after a comma, for one more."""
    before, comma, last = incomplete.rpartition(",")
    return [(f"{before}{comma}{name}", summary) for name, summary in _installed_methods("export", last)]


def kinds(incomplete: str) -> list[str]:
    """Return the kinds of methods."""
    return _matching(KIND_NAMES, incomplete)


def materials(incomplete: str) -> list[str]:
    """Return the materials that come with the program."""
    from ..materials.assignment import load_library

    return _matching(load_library(None), incomplete)


def scenes(incomplete: str) -> list[str]:
    """Return the builtin scenes that match; without a match, a shell completes names of files."""
    from ..scene.scene_files import BUILTINS

    return _matching(BUILTINS, incomplete) if incomplete else []


def keys(ctx: Any, incomplete: str) -> list[str]:
    """Return the keys that `--set` accepts; after `use=`, the methods; for a standard set named before, its pairs."""
    from ..pipeline.config.model import KEYS, STAGES

    if incomplete.startswith("export."):
        return _exporter_keys(incomplete)
    stage, use, _ = incomplete.partition(".use=")
    if use and stage in STAGES:
        return _matching((f"{stage}.use={name}" for name in default_registry().names(stage)), incomplete)
    if incomplete.startswith("scene."):
        return _scene_keys(ctx.params.get("sets") or (), incomplete)
    return _matching((setting for key in KEYS.values() for setting in key.settings()), incomplete)


def _scene_keys(words: Sequence[str], incomplete: str) -> list[str]:
    """Return the keys of scene readers; after `=`, the values that a reader suggests by earlier words of `--set`."""
    from ..files.yaml.source import parse_source, plain
    from ..pipeline.config.scene_readers import find_scene_reader, scene_readers

    key, equals, _ = incomplete.removeprefix("scene.").partition("=")
    try:
        if not equals:
            options = (option for reader in scene_readers() for option in reader.model_fields)
            return _matching((f"scene.{option}=" for option in options), incomplete)
        source = parse_source("{}", Path("here.yaml"), "", [word for word in words if word.startswith("scene")])
        block = plain(source.tree.get("scene"))
        block = cast("dict[str, Any]", block) if isinstance(block, dict) else {}
        reader = find_scene_reader({key: "", **block})
        values = reader.suggest(key, block) if reader else ()
        return _matching((f"scene.{key}={value}" for value in values), incomplete)
    except TangibleError:  # the earlier words are not finished, or the reader is broken
        return []


def _exporter_keys(incomplete: str) -> list[str]:
    """Return `export.NAME.` for each exporter; after a name, its options, which imports this exporter alone."""
    names = default_registry().names("export")
    name, dot, _ = incomplete.removeprefix("export.").partition(".")
    if not dot or name not in names:
        return _matching((f"export.{item}." for item in names), incomplete)
    try:
        options = default_registry().load("export", name).model_fields
    except TangibleError:
        return []
    return _matching((f"export.{name}.{option}=" for option in options), incomplete)


def _installed_methods(kind: str | None, incomplete: str) -> list[tuple[str, str]]:
    listings = [listing for listing in default_registry().listings if kind in (None, listing.kind)]
    return [(listing.name, listing.summary) for listing in listings if listing.name.startswith(incomplete)]


def _matching(names: Iterable[str], incomplete: str) -> list[str]:
    return [name for name in names if name.startswith(incomplete)]
