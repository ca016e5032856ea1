"""A surface in words, for pages to say: as a whole, and its materials by name."""

from typing import Any

from tangible_core.description import LANGUAGES, describe
from tangible_core.description.languages import TABLES
from tangible_core.pipeline.pipeline import Pipeline
from tangible_core.scene.workspace import kind_of

from .surface_view import Seen


def described(pipeline: Pipeline, seen: Seen) -> dict[str, Any]:
    """What is said of what is seen, by language; a material that has no name in a language keeps its own."""
    scene = pipeline.scene
    kind = kind_of(scene)
    names = {each.name for each in seen.materials}
    return {
        "digest": seen.digest,
        "says": {each: describe(seen.surface, scene.name, each, kind) for each in LANGUAGES},
        "names": {
            each: {name: said for name, said in TABLES[each].materials.items() if name in names} for each in LANGUAGES
        },
    }
