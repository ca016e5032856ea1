"""Exports: run exporters and move their files into the output folder, all files of one or none."""

import errno
import logging
import re
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from threading import Event
from time import perf_counter
from typing import Any, cast, final

import numpy as np

from ...data import Figure, HapticSurface, Note, Outcome, Outcomes, PartMap, Record, Relief, Work
from ...data.outcome import OutcomeKind
from ...data.products import EXPORTABLE
from ...drawing import PictureKind
from ...errors import (
    BrokenMethod,
    ConfigError,
    ModelAbsent,
    PictureError,
    Stopped,
    TangibleError,
    exit_error,
    quoted,
    wrong_argument,
)
from ...files.paths import without_folders
from ...files.writing import sole_writer, temporary_folder
from ...plugins import failures, hooks
from ...plugins.interfaces import Exporter
from ...plugins.naming import plugin_name
from ...plugins.notes import collect_notes
from ...plugins.registry import Registry
from ...preflight import Legibility
from ...runtime.stopping import check_stopped, stoppable
from ...scene.scene import Scene
from ...scene.scene_files import SceneFiles
from ..config.methods import NamedMethod
from ..config.model import PipelineConfig
from ..engine.engine import Engine
from ..engine.hooked import has_figure, networks_identity
from ..engine.planning import REQUESTED, with_notes
from ..engine.stage import Progress, StageEvent, ignore_event
from ..part_names import title_and_rest
from .export_engines import ExportEngines
from .export_result import Export, Exported
from .legible import drawn_parts, judge_products, names_of_parts, with_exporter_cures
from .result_folders import check_writable, check_written, default_name, move, relative_source

log: logging.Logger = logging.getLogger(__name__)

PREFIX = "export: "
# The most bytes of a file's name before its ending: systems take 255, and endings are added.
MAX_STEM_BYTES = 120
LOSSES = ("kept parts", "texts")  # the checks that name what is left out of a drawing
# The errors of a disk, for which the exporter is not to blame.
NO_ROOM = {errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EROFS, errno.EIO}


def chosen_exporters(
    config: PipelineConfig, to: Sequence[str | Exporter] | None, registry: Registry
) -> tuple[NamedMethod[Exporter], ...]:
    """Return the named exporters with their configured options; without names, all that the configuration lists."""
    if to is None:
        exporters = config.export
    else:
        to = [to] if isinstance(to, str | Exporter) else to
        exporters = tuple(method for exporter in to for method in _find_exporters(config, exporter, registry))
    if not exporters:
        names = ", ".join(registry.names("export"))
        cure = "`export(folder, to=[NAMES])`" if config.path is None else "`--to NAMES` or `export: [NAMES]`"
        raise ConfigError(f"no exporter is named; write {cure}; installed: {names}")
    return exporters


def _find_exporters(
    config: PipelineConfig, each: str | Exporter, registry: Registry
) -> tuple[NamedMethod[Exporter], ...]:
    if isinstance(each, Exporter):
        return (NamedMethod(type(each).__qualname__, "", each),)
    if not isinstance(each, cast(Any, str)):
        raise wrong_argument("to", each, "the name of an exporter, or an object of one")
    if own := tuple(method for method in config.export if method.name == each):
        return own
    listing, cls = registry.find("export", each), cast("type[Exporter]", registry.load("export", each))
    try:
        return (NamedMethod(each, listing.origin, cls()),)
    except ValueError as error:
        raise ConfigError(f"export: {each} has options that must be given; list it under `export:`") from error


def export(
    engine: Engine,
    folder: Path,
    exporters: Sequence[NamedMethod[Exporter]],
    progress: Progress | None = None,
    stop: Event | None = None,
    *,
    force: bool = False,
    cut: bool = False,
) -> Export:
    """Write the files of each exporter into a folder; one that fails does not stop the others."""
    stem = export_stem(engine.config, engine.scene)
    check_writable(folder)
    run = _ExportRun(ExportEngines(engine, exporters), folder, force, cut, progress or ignore_event)
    results, names = list[Exported](), Counter[str]()
    with sole_writer(folder / stem), stoppable(stop):
        for exporter in exporters:
            names[exporter.name] += 1
            number = f"-{names[exporter.name]}" if names[exporter.name] > 1 else ""
            results.append(run.export(f"{exporter.name}{number}", f"{stem}{number}", exporter))
    return Export(folder, tuple(results))


@final
@dataclass(frozen=True)
class _ExportRun:
    """The state of one call of `export`, whose exporters share their products."""

    engines: ExportEngines
    folder: Path
    force: bool
    cut: bool
    progress: Progress
    told: set[str] = field(default_factory=set[str])
    """What was said of parts that are left out: one exporter says it, as all have the same parts."""

    def export(self, name: str, stem: str, exporter: NamedMethod[Exporter]) -> Exported:
        outcomes, product, seconds = Outcomes(), f"{PREFIX}{name}", 0.0
        files, legible, notes, place = (), None, list[Note](), None
        plugins = self.engines.engine.registry.plugins

        def listen(stage: StageEvent) -> None:
            if stage.outcome is not None:
                outcomes.append(stage.outcome)
            self.progress(stage)

        try:
            engine = self.engines.engine_for(exporter)
            with engine.watching(listen):
                work = work_for(engine, exporter.method, cut=self.cut)
                legible = legible_for(engine, exporter)
                dropped = self._dropped(engine, exporter, legible)
            check_stopped()
            self.progress(StageEvent(product, exporter.name))
            hooks.tell(plugins, "tangible_stage_started", product=product, method=exporter.name)
            start = perf_counter()
            with temporary_folder(self.folder / "export") as place, collect_notes() as notes:
                files = self._write(exporter, work, place / stem)
            seconds = perf_counter() - start
            kind: OutcomeKind = "ran"
            notes = [*_illegible(exporter.name, legible), *dropped, *notes]
            why = with_notes(notes, REQUESTED)
        except Stopped:
            raise
        except (Exception, SystemExit) as error:  # noqa: BLE001 - whatever a plugin raises, the others still write
            kind, why = _fault(error, self.folder)
            if place is not None:  # the user has never seen where files are written before they are moved
                why = why.replace(str(place), str(self.folder))
        outcome = Outcome(product, kind, why, exporter.name, seconds, tuple(notes))
        self.progress(StageEvent(product, exporter.name, outcome))
        hooks.tell(plugins, "tangible_stage_finished", outcome=outcome)
        return Exported(name, outcome, files, outcomes, legible if kind == "ran" else None)

    def _dropped(self, engine: Engine, exporter: NamedMethod[Exporter], legible: Legibility | None) -> list[Note]:
        """Return notes on what these files lack of a drawing, unless the verdict says it, or an earlier exporter."""
        said, felt = "" if legible is None or legible.readable else legible.sentence, engine.config.felt_parts
        if legible is None and exporter.method.needs and engine.scene.kind.likely != PictureKind.photograph:
            products = {felt} & _inputs(engine, exporter.method)
            legible = judge_products(engine, "force", felt, products, exporter.method.shows_texts)
        verdicts = [verdict for verdict in legible or () if verdict.check in LOSSES and verdict.verdict != "ok"]
        new = [verdict for verdict in verdicts if verdict.says not in said and verdict.says not in self.told]
        self.told.update(verdict.says for verdict in verdicts if verdict.check == "kept parts")
        return [Note(verdict.says, "warning") for verdict in new]

    def _write(self, exporter: NamedMethod[Exporter], work: Work, stem: Path) -> tuple[Path, ...]:
        outputs = exporter.method.write(work, stem)
        check_stopped()
        paths = check_written(outputs, stem, _full_name(exporter.method))
        source = relative_source(self.engines.engine.config.path, self.folder)
        return move(paths, self.folder, source, exporter.name, self.force)


def _full_name(exporter: Exporter) -> str:
    return plugin_name("export", type(exporter).__module__, type(exporter).__qualname__)


def work_for(engine: Engine, exporter: Exporter, *, cut: bool = False) -> Work:
    """Make the work for an exporter: the products that it needs, on the working grid."""
    if odd := [need for need in exporter.needs if need not in EXPORTABLE]:
        name = _full_name(exporter)
        raise BrokenMethod(f"{name}: needs {quoted(odd[0])}; an exporter may need {', '.join(EXPORTABLE)}")
    products: dict[str, Record | None] = {name: engine.make_on_grid(name) for name in exporter.needs}
    views = engine.scene.views
    if cut:
        products = remove_ground(engine, products)
    extras = {"views": views, "truth": engine.scene.truth}
    if has_figure(engine.config, engine.registry):
        extras["figure"] = engine.make_on_grid("figure")
    title, texts = title_and_rest(engine)
    return Work(
        title or export_title(engine.config, engine.scene),
        engine.config.language,
        products,
        None if views is None else views.left,
        names_of_parts(engine.config, products),
        extras,
        kind=engine.scene.kind.likely,
        texts=texts,
        film=engine.scene.frames is not None,
    )


def legible_for(engine: Engine, exporter: NamedMethod[Exporter]) -> Legibility | None:
    """Judge the legibility by the products that an exporter needs; None for files that are not touched."""
    medium = exporter.method.medium
    if medium is None:
        return None
    products, shows_texts = _inputs(engine, exporter.method), exporter.method.shows_texts
    verdicts = judge_products(engine, medium, drawn_parts(engine, exporter), products, shows_texts)
    return with_exporter_cures(engine, exporter, verdicts)


def _inputs(engine: Engine, exporter: Exporter) -> set[str]:
    return set[str]().union(*map(engine.all_inputs, exporter.needs))


def _illegible(name: str, legible: Legibility | None) -> list[Note]:
    if legible is None or legible.readable:
        return []
    log.warning("%s: %s", name, legible.sentence)
    return [Note(legible.sentence, "warning")]


def export_title(config: PipelineConfig, scene: Scene) -> str:
    """Return the title for exporters: the configured one, the picture's own, or the scene's name without folder."""
    if title := config.title.strip() or scene.title:
        return title
    name = Path(without_folders(scene.name))
    return name.stem if isinstance(scene.files, SceneFiles) else name.name


def export_stem(config: PipelineConfig, scene: Scene) -> str:
    """Return the name of exported files without their endings: that of the pipeline file or of the scene, without dots.

    >>> export_stem(PipelineConfig(scene="builtin/coins", path=Path("maps/harbour.v2.yaml")), Scene("coins"))
    'harbour-v2'
    """
    name = export_title(config, scene) if config.path is None else default_name(config.path)
    plain = re.sub(r"[^\w -]+", "-", name).strip("- ")
    return plain.encode()[:MAX_STEM_BYTES].decode(errors="ignore") or "export"


def _fault(error: BaseException, folder: Path) -> tuple[OutcomeKind, str]:
    """Return the outcome of an exporter that raised this error, and its reason."""
    if isinstance(error, SystemExit):
        return "failed", str(exit_error(error))
    if isinstance(error, TangibleError):
        return "failed" if isinstance(error, BrokenMethod) else "refused", str(error)
    if isinstance(error, OSError) and error.errno in NO_ROOM:
        return "refused", f"{folder}: cannot be written: {error.strerror}; free some space or choose another folder"
    return "refused" if failures.lacks_memory(error) else "failed", failures.sentence(error)


def remove_ground(engine: Engine, products: Mapping[str, Record | None]) -> dict[str, Record | None]:
    """Return the products of an engine without their ground, which has no height, and is the last part."""
    figure: Figure = engine.make_on_grid("figure") if networks_identity(engine.registry) else Figure()
    if figure.figure is None:
        raise ModelAbsent("a cut-out needs the network that sees figures; `tangible networks add figure` fetches it")
    if not figure.is_figure(figure.figure.shape).any():
        raise PictureError("nothing stands out from its ground in this picture, so nothing is cut out")
    return {name: flatten_ground(record, figure) for name, record in products.items()}


def flatten_ground(record: Record | None, figure: Figure) -> Any:
    """Return a product without its ground."""
    match record:
        case Relief():
            shape = record.height_m.shape
            return replace(record, height_m=np.where(figure.is_figure(shape), record.height_m, np.float32(0)))
        case HapticSurface():
            return replace(record, relief=flatten_ground(record.relief, figure))
        case PartMap():
            labels = np.where(figure.is_figure(record.labels.shape), record.labels, np.int32(record.count))
            return PartMap(labels, (*record.segments, max(record.segments) + 1))
        case _:
            return record
