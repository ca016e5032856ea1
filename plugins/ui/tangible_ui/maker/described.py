"""A surface in words, for pages to say: as a whole, and its materials by name."""

from typing import Any, get_args

from tangible_core.data import HapticSurface
from tangible_core.pipeline.pipeline import Pipeline
from tangible_core.scene.description import Language, describe
from tangible_core.scene.description_words import MATERIALS
from tangible_core.scene.workspace import kind_of

from .seen import Seen


def described(pipeline: Pipeline, seen: Seen) -> dict[str, Any]:
    """What is said of what is seen, by language; a material that has no name in a language keeps its own."""
    scene = pipeline.scene
    kind = kind_of(scene)
    surface = HapticSurface(seen.relief)
    if seen.materials or seen.names:
        surface = HapticSurface(seen.relief, seen.labels, seen.materials or None, seen.names)
    names = {each.name for each in seen.materials} & MATERIALS.keys()
    languages = get_args(Language)
    return {
        "digest": seen.digest,
        "says": {each: describe(surface, scene.name, each, kind) for each in languages},
        "names": {each: {name: MATERIALS[name][column] for name in names} for column, each in enumerate(languages)},
    }
