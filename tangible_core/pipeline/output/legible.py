"""The legibility of a pipeline's products for fingers, at the configured or at another width."""

from collections.abc import Collection, Mapping
from typing import Any, get_args

from ...data import PartMap, Record
from ...errors import ConfigError, did_you_mean, quoted
from ...legibility import Legibility, legibility
from ...plugins.interfaces import Medium
from ...scene.workspace import Workspace
from ..config.model import PipelineConfig
from ..config.part_names import names_of
from ..engine.engine import Engine
from ..engine.working_grid import WorkingGrid

ROUNDING = 1e-9
"""A share above the rounding error of a product of floating-point numbers."""
JUDGED: Mapping[Medium, tuple[str, ...]] = {"print": ("relief",), "force": ("relief", "materials")}
"""Products that the rules of a medium judge next to the parts."""


def legible(engine: Engine, medium: Medium) -> Legibility:
    """Judge the engine's parts at its width. Raises: ConfigError for an unknown medium; as `Engine.make`."""
    if medium not in (media := get_args(Medium)):
        raise ConfigError(f"medium: is {quoted(medium)}{did_you_mean(str(medium), media)}; it is {', '.join(media)}")
    parts = engine.config.felt_parts
    return judge_products(engine, medium, parts, {parts, *JUDGED.get(medium, ())})


def judge_products(engine: Engine, medium: Medium, parts: str, judged: Collection[str]) -> Legibility:
    """Judge the legibility by these products alone. parts: the product with the parts. Raises: TangibleError."""
    names = [name for name in (parts, "relief", "materials") if name in judged]
    products: dict[str, Any] = {name: engine.make_on_grid(name) for name in names}
    others = {name: products[name] for name in JUDGED.get(medium, ()) if name in products}
    part_map: PartMap | None = products.get(parts)
    width_m = engine.config.size.width_m
    return legibility(medium, part_map, width_m, names=names_of_parts(engine.config, products), **others)


def with_width(engine: Engine, width_m: float | None) -> Engine:
    """Return an engine for another width; the grid gets no finer, so that the same parts are found.

    width_m: None for the same width. Raises: ConfigError for a width out of bounds.
    """
    config = engine.config
    if width_m is None or width_m == config.size.width_m:
        return engine
    columns, factor = engine.scene.shape[1], WorkingGrid(engine.scene, config.size).factor
    finest_m = 0.0 if factor == 1 else factor * width_m / columns * (1 + ROUNDING)
    try:
        workspace = Workspace.model_validate({**dict(config.workspace), "width_m": width_m, "finest_m": finest_m})
    except ValueError as error:
        raise ConfigError(f"width_m: is {quoted(width_m)}; a width is from 1e-6 to 10 m") from error
    return engine.with_config(config.with_values(workspace=workspace))


def names_of_parts(config: PipelineConfig, products: Mapping[str, Record | None]) -> tuple[str, ...]:
    """Return the names of all parts, as many as the products have; none without configured parts."""
    if not config.parts:
        return ()
    counts = [each.count for each in products.values() if isinstance(each, PartMap)]
    return names_of(config.parts, max(counts, default=max(config.parts) + 1))
