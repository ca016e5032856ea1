"""What a shell offers for a word that is not finished: names that are read from metadata, none of it slowly."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any, cast


def methods(ctx: Any, incomplete: str) -> list[tuple[str, str]]:
    """Methods of the kind that stands before, with what they do."""
    return _installed(ctx.params.get("kind"), incomplete)


def devices(incomplete: str) -> list[tuple[str, str]]:
    """Devices, with what they are."""
    return _installed("device", incomplete)


def exporters(incomplete: str) -> list[tuple[str, str]]:
    """Exporters, with what they write; behind a comma, one more."""
    before, comma, begun = incomplete.rpartition(",")
    return [(f"{before}{comma}{name}", summary) for name, summary in _installed("export", begun)]


def kinds(incomplete: str) -> list[str]:
    """Kinds of methods."""
    from ..plugins.registry import KIND_NAMES

    return _beginning(KIND_NAMES, incomplete)


def materials(incomplete: str) -> list[str]:
    """Materials that are shipped."""
    from ..materials.assignment import load_library

    return _beginning(load_library(None), incomplete)


def scenes(incomplete: str) -> list[str]:
    """Builtin scenes, once a word looks like one: a shell completes names of files where nothing is offered."""
    from ..scene.scene_files import BUILTINS

    return _beginning(BUILTINS, incomplete) if incomplete else []


def keys(ctx: Any, incomplete: str) -> list[str]:
    """Keys of a pipeline file, as `--set` takes them; after `use=`, the methods; of a standard set that
    was named before, its pairs."""
    from ..pipeline.config.model import KEYS, STAGES
    from ..plugins.registry import default_registry

    if incomplete.startswith("export."):
        return _of_exporters(incomplete)
    stage, use, _ = incomplete.partition(".use=")
    if use and stage in STAGES:
        return _beginning((f"{stage}.use={name}" for name in default_registry().names(stage)), incomplete)
    if incomplete.startswith("scene."):
        return _of_scene(ctx.params.get("sets") or (), incomplete)
    return _beginning((setting for key in KEYS.values() for setting in key.settings()), incomplete)


def _of_scene(words: Sequence[str], incomplete: str) -> list[str]:
    """Keys of the scene readers; after `=`, the values that a reader suggests by the earlier words of `--set`."""
    from ..errors import TangibleError
    from ..files.yaml.source import parse_source, plain
    from ..pipeline.config.scene_readers import scene_reader_of, scene_readers

    key, equals, _ = incomplete.removeprefix("scene.").partition("=")
    try:
        if not equals:
            options = (option for reader in scene_readers() for option in reader.model_fields)
            return _beginning((f"scene.{option}=" for option in options), incomplete)
        said = parse_source("{}", Path("here.yaml"), "", [each for each in words if each.startswith("scene")])
        block = plain(said.tree.get("scene"))
        block = cast("dict[str, Any]", block) if isinstance(block, dict) else {}
        reader = scene_reader_of({key: "", **block})
        values = reader.suggest(key, block) if reader else ()
        return _beginning((f"scene.{key}={value}" for value in values), incomplete)
    except TangibleError:  # the earlier words are not finished, or the reader is broken
        return []


def _of_exporters(incomplete: str) -> list[str]:
    """`export.NAME.`, and behind that the options of this one alone: no other is imported."""
    from ..errors import TangibleError
    from ..plugins.registry import default_registry

    names = default_registry().names("export")
    name, dot, _ = incomplete.removeprefix("export.").partition(".")
    if not dot or name not in names:
        return _beginning((f"export.{each}." for each in names), incomplete)
    try:
        options = default_registry().load("export", name).model_fields
    except TangibleError:
        return []
    return _beginning((f"export.{name}.{option}=" for option in options), incomplete)


def _installed(kind: str | None, incomplete: str) -> list[tuple[str, str]]:
    from ..plugins.registry import default_registry

    found = [each for each in default_registry().listings if kind in (None, each.kind)]
    return [(each.name, each.summary) for each in found if each.name.startswith(incomplete)]


def _beginning(names: Iterable[str], incomplete: str) -> list[str]:
    return [name for name in names if name.startswith(incomplete)]
