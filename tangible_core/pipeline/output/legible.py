"""Whether fingers can read what a pipeline makes, of the width that it has or is to have."""

from collections.abc import Collection, Mapping
from typing import Any

from ...data import PartMap, Record
from ...errors import ConfigError, quoted
from ...legibility import Legibility, legibility
from ...plugins.interfaces import Medium
from ...scene.workspace import Workspace
from ..config.model import PipelineConfig
from ..config.part_names import names_of
from ..engine.engine import Engine
from ..engine.working_grid import WorkingGrid

ROUNDING = 1e-9
"""A share by which a product of floating-point numbers may be off, and more."""
LOOKED_AT: Mapping[Medium, tuple[str, ...]] = {"print": ("relief",), "force": ("relief", "materials")}
"""Products that a medium's rules are about, beside the parts."""


def legible(engine: Engine, medium: Medium) -> Legibility:
    """Of what the engine makes, at its width. Raises: TangibleError as `Engine.make`."""
    parts = engine.config.felt_parts
    return judged(engine, medium, parts, {parts, *LOOKED_AT.get(medium, ())})


def judged(engine: Engine, medium: Medium, parts: str, looked_at: Collection[str]) -> Legibility:
    """Of no other products than these. parts: the product whose parts are read. Raises: TangibleError as `make`."""
    found: dict[str, Any] = {
        name: engine.make_on_grid(name) for name in (parts, "relief", "materials") if name in looked_at
    }
    said = {name: found[name] for name in LOOKED_AT.get(medium, ()) if name in found}
    read: PartMap | None = found.get(parts)
    return legibility(medium, read, engine.config.size.width_m, names=names(engine.config, found), **said)


def of_width(engine: Engine, width_m: float | None) -> Engine:
    """The same, so wide: what is found in the picture stays the same, as it is looked at no finer than before.

    width_m: None for as wide as it is. Raises: ConfigError for what is no width.
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


def names(config: PipelineConfig, products: Mapping[str, Record | None]) -> tuple[str, ...]:
    """Names of all parts, as far as it is known how many there are; none where nothing is said of parts."""
    if not config.parts:
        return ()
    counts = [made.count for made in products.values() if isinstance(made, PartMap)]
    return names_of(config.parts, max(counts, default=max(config.parts) + 1))
