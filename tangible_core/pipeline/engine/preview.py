"""Heights and materials of parts that are tried: the surface and its touch while a hand drags them."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from math import ceil, sqrt
from typing import Any, NamedTuple, TypeVar, final

import numpy as np
from pydantic import BaseModel, ValidationError

from ...data import HapticSurface, MaterialMap, Record
from ...data.products import Product
from ...errors import ConfigError
from ...materials.assignment import find, load_library
from ...parts import HeightChoice, Layering, PartChoice
from ...plugins.interfaces import Touch
from ...plugins.notes import silently
from ...scene.scaling import felt_factor
from ..config.model import PipelineConfig
from ..config.part_checks import wrong_of_parts
from .engine import Engine
from .part_validation import check_numbers, check_parts, own_materials
from .stage import Context
from .stages.relief import ReliefStage
from .stages.touch import fit_to_device
from .working_grid import WorkingGrid, parts_on_grid, relief_of_layers

S = TypeVar("S", bound=BaseModel)
MAX_CELLS = 500_000  # maximum number of cells of a surface that changes under the hand


class TriedSurface(NamedTuple):
    """What is made of heights that are tried."""

    surface: HapticSurface
    felt: HapticSurface  # the surface within the limits of the device
    touch: Touch


def config_heights(config: PipelineConfig) -> HeightChoice:
    """Return the document's recipe for a relief of parts; without one, heights that are all given."""
    return config.heights or HeightChoice(by="given")


def preview_config(config: PipelineConfig, heights: Mapping[str, Any] | None, shape: tuple[int, int]) -> PipelineConfig:
    """Return the configuration of a preview: heights that are all given, on a grid of about MAX_CELLS at most."""
    if config.render is None:
        raise config.missing("render")
    choice = {**config_heights(config).model_dump(), **(heights or {}), "by": "given"}
    preview = config.with_values(heights=_validate(HeightChoice, choice), parts=config.parts or {})
    if wrong := list(wrong_of_parts(preview)):
        raise preview.error_at(*wrong)
    size, (rows, columns) = config.size, shape
    factor = ceil(2 * sqrt(rows * columns / MAX_CELLS)) / 2  # in steps of half a pixel
    if factor <= felt_factor(columns, size.width_m, size.finest_m):
        return preview
    finest_m = (factor + 0.01) * size.width_m / columns
    return preview.with_values(workspace=preview.workspace.model_copy(update={"finest_m": finest_m}))


def without_entries(config: PipelineConfig) -> PipelineConfig:
    """Return the configuration with the parts' names alone, by which rules may refer to them, and without its text."""
    names = {number: PartChoice(name=part.name) for number, part in (config.parts or {}).items() if part.name}
    return config.with_values(parts=names, title="", language="en", source=None)


@final
class PartHeightPreview:
    """Everything that is the same for all heights of one document's parts."""

    def __init__(self, engine: Engine, before: "PartHeightPreview | None" = None) -> None:
        """Make what does not depend on heights; the layers of `before` are taken over if the parts are the same."""
        self.engine: Engine = engine
        config = engine.config
        self.grid: WorkingGrid = WorkingGrid(engine.scene, config.size)
        self._parts = parts_on_grid(engine.make_on_grid(config.felt_parts), self.grid.shape, config.felt_parts)
        uses = config.render is None or config.render.method.uses_materials
        self._materials: MaterialMap | None = engine.make("materials") if uses else None
        """Materials by part, for parts without an own one; None if the law uses none."""
        self._recipe_heights_m: dict[str, tuple[float, ...]] = {}
        """Heights that each requested recipe finds, by part."""
        if before is not None and self._shares_layers(before):
            self._layering = before._layering
        else:
            assert config.heights is not None
            views = self.grid.views
            self._layering = Layering(self._parts, config.size.width_m, config.heights, views.left if views else None)

    def holds_for(self, engine: Engine) -> bool:
        """Return True if a new preview of this engine would be the same."""
        return self.engine.scene is engine.scene and self.engine.config == engine.config

    def try_heights(
        self,
        config: PipelineConfig,
        heights_m: Sequence[float | None],
        by: str,
        materials: Sequence[str | None] | None = None,
    ) -> TriedSurface:
        """Make surface and touch of parts at other heights; None stands for what the recipe `by` or document has."""
        choices = {
            number: _validate(PartChoice, {"height_m": height_m}) for number, height_m in enumerate(heights_m, 1)
        }
        check_parts(config.with_values(parts=choices), self._parts, self.grid.scene.shape[1])
        check_numbers(config, self._parts.count)
        known_m = self._known_heights(heights_m, by)
        relief = relief_of_layers(self._layering, known_m, config.size, self.grid.opaque_mask)
        products: dict[str, Record] = {config.felt_parts: self._parts, "relief": relief}
        if self._materials is not None:
            own = own_materials(config) if materials is None else dict(enumerate(materials))
            library = load_library(config.materials.library)
            overrides = {number: find(name, library) for number, name in own.items() if name is not None}
            defaults = self._materials.materials
            new_materials = tuple(overrides.get(number, material) for number, material in enumerate(defaults))
            products["materials"] = replace(self._materials, materials=new_materials)
        engine = self.engine.with_products(**products)
        surface: HapticSurface = engine.make("surface")
        device = config.felt_device
        limited_surface = surface if device is None else fit_to_device(surface, config, device)[0]
        with silently():  # else every step of a height would log the device's limits
            return TriedSurface(surface, limited_surface, engine.make("touch"))

    def _known_heights(self, heights_m: Sequence[float | None], by: str) -> list[float]:
        """Return the heights, with what the recipe finds for None. Raises: ConfigError for a depth that is not made."""
        if None in heights_m and by not in self._recipe_heights_m:
            disparity = product_at_hand(self.engine, "disparity") if by == "depth" else None
            if by == "depth" and disparity is None:
                raise ConfigError("the picture's depth is not made yet; make it, and heights by depth are felt")
            config = self.engine.config
            choice = _validate(HeightChoice, {**config_heights(config).model_dump(), "by": by})
            stage = ReliefStage(Context(config.with_values(heights=choice), self.engine.scene))
            self._recipe_heights_m[by] = stage.part_heights(self._parts, disparity).heights_m
        found_m = self._recipe_heights_m.get(by, ())
        return [
            found_m[number] if height_m is None and number < len(found_m) else height_m or 0.0
            for number, height_m in enumerate(heights_m)
        ]

    def _shares_layers(self, before: "PartHeightPreview") -> bool:
        config, earlier = self.engine.config, before.engine.config
        same = earlier.heights == config.heights and earlier.size == config.size
        is_here = before.grid.scene is self.grid.scene
        return same and is_here and np.array_equal(before._parts.labels, self._parts.labels)


def is_at_hand(engine: Engine, product: Product) -> bool:
    """Return True if a product is available without making it: given, made, or cached."""
    outcomes = {outcome.product: outcome.outcome for outcome in engine.outcomes}
    if outcomes.get(product) in ("given", "ran", "cached"):
        return True
    steps = {step.product: step.outcome for step in engine.plan(product).steps}
    return steps.get(product) in ("given", "cached")


def product_at_hand(engine: Engine, product: Product) -> Any:
    """Return a product on the working grid; None if it would have to be made."""
    return engine.make_on_grid(product) if is_at_hand(engine, product) else None


def _validate(section: type[S], values: Mapping[str, Any]) -> S:
    """Validate options. Raises: ConfigError."""
    try:
        return section.model_validate(values)
    except ValidationError as error:
        first = error.errors()[0]
        raise ConfigError(f"{'.'.join(map(str, first['loc']))}: {first['msg']}") from error
