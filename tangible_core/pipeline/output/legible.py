"""The legibility of a pipeline's products for fingers, at the width that export draws or at another one."""

from collections.abc import Collection, Mapping
from contextlib import suppress
from dataclasses import replace
from typing import Any, Literal, cast, get_args

from ...data import PartMap, Record
from ...drawing import DrawnPicture, PictureKind
from ...errors import ConfigError, TangibleError, did_you_mean, quoted
from ...plugins.interfaces import Exporter, Medium
from ...preflight import Legibility
from ...preflight.verdict import Change, Verdict
from ...scene.workspace import Workspace
from ..config.methods import NamedMethod
from ..config.model import PipelineConfig
from ..config.part_checks import all_part_names
from ..engine.engine import Engine
from ..engine.hooked import judge_function
from ..engine.working_grid import WorkingGrid
from ..part_names import picture_texts, title_and_rest

WIDTH = "workspace.width_m"
ROUNDING = 1e-9  # a share above the rounding error of a product of floating-point numbers
# The most kinds of fills on a page: neighbours differ, and others may be alike.
MAX_FILLS = 5
JUDGED: Mapping[Medium, tuple[str, ...]] = {"print": ("relief",), "force": ("relief", "materials")}
"""Products that the rules of a medium judge next to the parts."""


def legible(engine: Engine, medium: Medium, width_m: float | None = None) -> Legibility:
    """Judge the engine's parts at the width that export draws, or at another one."""
    if medium not in (media := get_args(Medium)):
        raise ConfigError(f"medium: is {quoted(medium)}{did_you_mean(str(medium), media)}; it is {', '.join(media)}")
    exporter = exporter_for(engine, medium)
    wide_engine = with_width(engine, drawn_width_m(engine, exporter) if width_m is None else width_m)
    parts, shows = drawn_parts(engine, exporter), exporter is not None and exporter.method.shows_texts
    verdicts = judge_products(wide_engine, medium, parts, {parts, *JUDGED.get(medium, ())}, shows)
    return verdicts if exporter is None else with_exporter_cures(engine, exporter, verdicts)


def exporter_for(engine: Engine, medium: Medium) -> NamedMethod[Exporter] | None:
    """Return the exporter that draws for a medium: the configured one, else the installed one; None if none does."""
    if own := next((each for each in engine.config.export if each.method.medium == medium), None):
        return own
    registry = engine.registry
    for name in sorted(registry.names("export"), key=lambda each: (each != medium, each)):
        with suppress(TangibleError, ValueError):  # one that is broken, or has options that must be given
            cls = cast("type[Exporter]", registry.load("export", name))
            if cls.medium == medium:
                return NamedMethod(name, registry.find("export", name).origin, cls())
    return None


def drawn_parts(engine: Engine, exporter: NamedMethod[Exporter] | None) -> Literal["parts", "simplified"]:
    """Return the product with the parts that an exporter draws; the parts that are felt without one."""
    needs = () if exporter is None else exporter.method.needs
    return "simplified" if "simplified" in needs else engine.config.felt_parts


def drawn_width_m(engine: Engine, *exporters: NamedMethod[Exporter] | None) -> float:
    """Return the width of the whole picture in the files of the first exporter that has one, else the workspace's."""
    # Solids of maps at a scale have this scale, so that they fit together.
    to_scale = engine.config.workspace.scale is not None
    methods = (each.method for each in exporters if each and not (to_scale and each.method.medium == "print"))
    widths_m = (method.picture_width_m(_aspect(engine)) for method in methods)
    return next((width_m for width_m in widths_m if width_m is not None), engine.config.size.width_m)


def with_exporter_cures(engine: Engine, exporter: NamedMethod[Exporter], verdicts: Legibility) -> Legibility:
    """Return the verdicts with cures that change the width in the exporter's options, where it has its own width."""
    aspect = _aspect(engine)
    if exporter.method.picture_width_m(aspect) is None:
        return verdicts
    return Legibility(_with_exporter_width(exporter, verdict, aspect) for verdict in verdicts)


def _with_exporter_width(exporter: NamedMethod[Exporter], verdict: Verdict, aspect: float) -> Verdict:
    wider = next((change for change in verdict.changes if change.key == WIDTH), None)
    if wider is None:
        return verdict
    options = exporter.method.options_for_width(float(wider.value), aspect)
    width_changes = [Change(f"export.{exporter.name}.{name}", f"{value}", "is") for name, value in options.items()]
    changes = tuple(new for change in verdict.changes for new in (width_changes if change is wider else [change]))
    cure = verdict.cure.replace(f"{wider}, ", "".join(f"{change_of_width}, " for change_of_width in width_changes))
    return replace(verdict, cure=cure.replace(f"{wider}", ", ".join(map(str, width_changes))), changes=changes)


def _aspect(engine: Engine) -> float:
    (rows, columns), size = engine.scene.shape, engine.scene.measured
    return columns / rows if size is None else size.width_m / size.length_m


def judge_products(engine: Engine, medium: Medium, parts: str, judged: Collection[str], texts: bool) -> Legibility:
    """Judge the legibility by these products alone. texts: True where texts that are read are shown."""
    names = [name for name in (parts, "relief", "materials") if name in judged]
    products: dict[str, Any] = {name: engine.make_on_grid(name) for name in names}
    others = {name: products[name] for name in JUDGED.get(medium, ()) if name in products}
    part_map: PartMap | None = products.get(parts)
    if (drawing := _drawing(engine, medium, part_map, texts)) is not None:
        others["drawing"] = drawing
        if medium == "swell" and part_map is not None:
            others["textures"] = min(MAX_FILLS, len(set(part_map.segments)))
    width_m = engine.config.size.width_m
    judge = judge_function(engine.registry)
    return judge(medium, part_map, width_m, names=names_of_parts(engine.config, products), **others)


def _drawing(engine: Engine, medium: Medium, parts: PartMap | None, texts: bool) -> DrawnPicture | None:
    """Return the picture if it is a drawing, and what this medium shows of it; None for a photograph."""
    kind, views, config = engine.scene.kind.likely, engine.scene.views, engine.config
    if kind == PictureKind.photograph or views is None:
        return None
    raised = medium in ("print", "force") and config.relief_kind == "lines"
    whole = None if parts is None else cast("PartMap | None", engine.make_on_grid("parts"))
    lost = tuple(text for text in title_and_rest(engine)[1] if not (texts and text.content))
    count = len(picture_texts(engine.scene, engine.registry))
    return DrawnPicture(kind, views.left, medium == "swell" or raised, whole, lost, count)


def with_width(engine: Engine, width_m: float | None) -> Engine:
    """Return an engine for another width; the grid gets no finer, so that the same parts are found."""
    config = engine.config
    if width_m is None or width_m == config.size.width_m:
        return engine
    columns, factor = engine.scene.shape[1], WorkingGrid(engine.scene, config.size).factor
    finest_m = 0.0 if factor == 1 else factor * width_m / columns * (1 + ROUNDING)
    times, before_m = config.workspace.times, config.size.width_m
    wide = {"width_m": width_m} if times is None else {"scale": f"1:{times * before_m / width_m:f}"}
    try:
        workspace = Workspace.model_validate({**config.workspace.model_dump(), **wide, "finest_m": finest_m})
    except ValueError as error:
        raise ConfigError(f"width_m: is {quoted(width_m)}; a width is from 1e-6 to 10 m") from error
    return engine.with_config(config.with_values(workspace=workspace))


def names_of_parts(config: PipelineConfig, products: Mapping[str, Record | None]) -> tuple[str, ...]:
    """Return the names of all parts, as many as the products have; none without configured parts."""
    if not config.parts:
        return ()
    counts = [product.count for product in products.values() if isinstance(product, PartMap)]
    return all_part_names(config, max(counts, default=max(config.parts)))
