"""What a shell offers for a word that is not finished: names that are read from metadata, none of it slowly."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any


def methods(ctx: Any, incomplete: str) -> list[tuple[str, str]]:
    """Methods of the kind that stands before, with what they do."""
    return _installed(ctx.params.get("kind"), incomplete)


def devices(incomplete: str) -> list[tuple[str, str]]:
    """Devices, with what they are."""
    return _installed("device", incomplete)


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


def comparisons(incomplete: str) -> list[tuple[str, str]]:
    """Standard sets, once a word looks like one: a shell completes names of files where nothing is offered."""
    from ..datasets import SETS

    return [(name, each.title) for name, each in SETS.items() if incomplete and name.startswith(incomplete)]


def keys(incomplete: str) -> list[str]:
    """Keys of a pipeline file, as `--set` takes them; after `use=`, the methods."""
    from ..pipeline.config import SECTIONS, STAGES
    from ..plugins.registry import default_registry

    stage, use, _ = incomplete.partition(".use=")
    if use and stage in STAGES:
        return _beginning((f"{stage}.use={name}" for name in default_registry().names(stage)), incomplete)
    if incomplete.startswith("scene.set="):
        from ..datasets import SETS

        return _beginning((f"scene.set={name}" for name in SETS), incomplete)
    found = [f"{name}.{option}=" for name, section in SECTIONS.items() for option in section.model_fields]
    alone = ("scene", "scene.set", "scene.folder", "scene.name", "title", "language", "want", "heights")
    return _beginning((*(f"{key}=" for key in alone), *(f"{stage}.use=" for stage in STAGES), *found), incomplete)


def _installed(kind: str | None, incomplete: str) -> list[tuple[str, str]]:
    from ..plugins.registry import default_registry

    found = [each for each in default_registry().listings if kind in (None, each.kind)]
    return [(each.name, each.summary) for each in found if each.name.startswith(incomplete)]


def _beginning(names: Iterable[str], incomplete: str) -> list[str]:
    return [name for name in names if name.startswith(incomplete)]
