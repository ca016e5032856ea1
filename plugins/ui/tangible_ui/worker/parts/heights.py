"""Heights and materials of parts that are felt and shown while they change.

What does not depend on the heights is computed once and kept. The surface is, to the bit, what the document gives once
it has these heights: the same stages make it (`Engine.with_products`). Only one of more than MOST_CELLS is computed on
a coarser grid until it is saved: a hand that drags a height must not wait.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from math import ceil, sqrt
from typing import Any, TypeVar

import numpy as np
from pydantic import BaseModel, ValidationError

from tangible_core.data import HapticSurface, Material, MaterialMap, PartMap
from tangible_core.errors import ConfigError
from tangible_core.materials.assignment import find, load_library
from tangible_core.parts import HeightChoice, Layering, PartChoice
from tangible_core.pipeline.config.model import PipelineConfig
from tangible_core.pipeline.config.part_checks import wrong_of_parts
from tangible_core.pipeline.engine import working_grid
from tangible_core.pipeline.engine.stage import Context
from tangible_core.pipeline.engine.stages.relief import ReliefStage
from tangible_core.pipeline.pipeline import Pipeline
from tangible_core.scene.scaling import felt_factor
from tangible_core.scene.scene import Scene

from ..state import WorkerState
from ..view.surface_view import SurfaceView, at_hand
from .opening import config_heights

S = TypeVar("S", bound=BaseModel)
MOST_CELLS = 500_000
"""Maximum number of cells of a surface that changes under the hand."""


@dataclass
class Kept:
    """Results that are the same for all heights."""

    scene: Scene
    config: PipelineConfig
    """The configuration with the parts' names alone, by which rules may refer to them."""
    pipeline: Pipeline
    grid: working_grid.WorkingGrid
    parts: PartMap
    """Parts on the working grid."""
    materials: MaterialMap | None
    """Materials by part, for parts without an own one; None if the law uses none."""
    layering: Layering
    found_m: dict[str, tuple[float, ...]] = field(default_factory=dict[str, tuple[float, ...]])
    """Heights that each requested recipe finds, by part."""
    seen: SurfaceView | None = None
    """The last view; `surface` is the current surface if that is a newer one."""
    surface: HapticSurface | None = None


def of_parts(config: PipelineConfig, heights: Mapping[str, Any] | None) -> PipelineConfig:
    """Return the configuration with a relief of parts whose heights are all given."""
    choice = config_heights(config)
    told = {**choice.model_dump(), **(heights or {}), "by": "given"}
    return config.with_values(heights=validate(HeightChoice, told), parts=config.parts or {})


def coarse(config: PipelineConfig, shape: tuple[int, int]) -> PipelineConfig:
    """Return the configuration with a grid of about MOST_CELLS at most, in steps of half a pixel."""
    size, (rows, columns) = config.size, shape
    factor = ceil(2 * sqrt(rows * columns / MOST_CELLS)) / 2
    if factor <= felt_factor(columns, size.width_m, size.finest_m):
        return config
    finest_m = (factor + 0.01) * size.width_m / columns
    return config.with_values(workspace=config.workspace.model_copy(update={"finest_m": finest_m}))


def validate(section: type[S], said: Mapping[str, Any]) -> S:
    """Validate options. Raises: ConfigError."""
    try:
        return section.model_validate(said)
    except ValidationError as error:
        first = error.errors()[0]
        raise ConfigError(f"{'.'.join(map(str, first['loc']))}: {first['msg']}") from error


def known_heights(kept: Kept, heights_m: Sequence[float | None], by: str) -> list[float]:
    """Return the heights, with what the recipe finds for None. Raises: ConfigError for a depth that is not made yet."""
    if None in heights_m and by not in kept.found_m:
        assert kept.config.heights is not None
        disparity = at_hand(kept.pipeline, "disparity") if by == "depth" else None
        if by == "depth" and disparity is None:
            raise ConfigError("the picture's depth is not made yet; make it, and heights by depth are felt")
        recipe = kept.config.with_values(heights=validate(HeightChoice, {**kept.config.heights.model_dump(), "by": by}))
        kept.found_m[by] = ReliefStage(Context(recipe, kept.scene)).part_heights(kept.parts, disparity).heights_m
    found_m = kept.found_m.get(by, ())
    return [found_m[number] if each is None and number < len(found_m) else each or 0.0
            for number, each in enumerate(heights_m)]  # fmt: skip


def kept_of(state: WorkerState, pipeline: Pipeline) -> Kept:
    """Return what was kept, as far as it still holds; compute the rest."""
    config, before = pipeline.config, state.kept
    named = {number: PartChoice(name=each.name) for number, each in (config.parts or {}).items() if each.name}
    bare = config.with_values(parts=named, title="", language="en", source=None)
    if before is not None and before.scene is pipeline.scene and before.config == bare:
        return before
    if wrong := list(wrong_of_parts(config)):
        raise config.error_at(*wrong)
    made = Pipeline.from_config(bare, like=pipeline)
    grid = working_grid.WorkingGrid(made.scene, bare.size)
    parts = working_grid.parts_on_grid(made.engine.make_on_grid(bare.felt_parts), grid.shape, bare.felt_parts)
    uses = bare.render is None or bare.render.method.uses_materials
    chosen = made.make("materials") if uses else None
    if before and _has_layering(before, bare, parts, grid):
        layering = before.layering
    else:
        assert bare.heights is not None
        layering = Layering(parts, bare.size.width_m, bare.heights, grid.views.left if grid.views else None)
    state.kept = kept = Kept(made.scene, bare, made, grid, parts, chosen, layering)
    return kept


def _has_layering(before: Kept, config: PipelineConfig, parts: PartMap, grid: working_grid.WorkingGrid) -> bool:
    """Return True if the kept layering is of these parts."""
    same = before.config.heights == config.heights and before.config.size == config.size
    return same and before.grid.scene is grid.scene and np.array_equal(before.parts.labels, parts.labels)


def materials_of(
    found: tuple[Material, ...], own: Mapping[int, str | None], config: PipelineConfig
) -> tuple[Material, ...]:
    """Replace materials by those of the parts. Raises: MaterialError for a name that is not in the library."""
    library = load_library(config.materials.library)
    named = {number: find(name, library) for number, name in own.items() if name is not None}
    return tuple(named.get(number, each) for number, each in enumerate(found))
