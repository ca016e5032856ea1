"""Handing on: exporters get what they need, and their files come into a folder, each whole or not at all."""

import errno
import logging
import re
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from threading import Event
from time import perf_counter
from typing import Any, cast, final

from ...data import Note, Outcome, Outcomes, Record, Work
from ...data.outcome import HEADINGS, OutcomeKind, html_table, text_table
from ...data.products import EXPORTABLE
from ...errors import BrokenMethod, ConfigError, Stopped, TangibleError, exit_error, quoted, wrong_argument
from ...legibility import Legibility
from ...plugins import failures, hooks
from ...plugins.interfaces import Exporter
from ...plugins.naming import plugin_name
from ...plugins.notes import collect_notes
from ...plugins.registry import Registry
from ...runtime.stopping import check_stopped, stoppable
from ...scene.scene import Scene
from ...scene.scene_files import SceneFiles
from ..config.methods import NamedMethod
from ..config.model import PipelineConfig
from ..engine.engine import Engine
from ..engine.stage import Progress, StageEvent
from .export_folder import check_writable, check_written, move, scratch
from .legible import judged, names, of_width
from .run_folder import default_name, relative_source

log = logging.getLogger(__name__)

PREFIX = "export: "
"""Of an exporter's name, in what is said of its outcome."""
MOST_STEM_BYTES = 120
"""Of a file's name before its ending: systems take 255, and endings are added."""
NO_ROOM = {errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EROFS, errno.EIO}
"""What the disk says, whoever writes."""


@dataclass(frozen=True, eq=False)
class Exported:
    """What one exporter wrote, or why it did not."""

    name: str
    """The exporter's; with a number where it is there twice."""
    outcome: Outcome
    """`ran`; `refused` for what cannot be written of this, and the message says the cure; `failed` by a fault of the
    exporter."""
    files: tuple[Path, ...] = ()
    made: Outcomes = field(default_factory=Outcomes)
    """What became of the products that it needs."""
    legible: Legibility | None = None
    """Whether fingers can read it; None for what is not felt."""


@dataclass(frozen=True, eq=False, repr=False)
class Export:
    """What was written for others, and where. It shows itself as a table, in a terminal and in a notebook."""

    folder: Path
    exports: tuple[Exported, ...]
    """In the order in which they were asked for."""

    @property
    def files(self) -> dict[str, tuple[Path, ...]]:
        """The files of each exporter, by its name; none of one that wrote nothing."""
        return {each.name: each.files for each in self.exports}

    @property
    def outcomes(self) -> Outcomes:
        """What became of each exporter."""
        return Outcomes(each.outcome for each in self.exports)

    def document(self) -> dict[str, Any]:
        """Everything as plain values."""
        return {"folder": str(self.folder), "exports": [_as_data(each) for each in self.exports]}

    def __repr__(self) -> str:
        return text_table((*HEADINGS, "files"), self._rows())

    def _repr_html_(self) -> str:
        return html_table((*HEADINGS, "files"), self._rows())

    def _rows(self) -> list[tuple[str, ...]]:
        return [(*each.outcome.row(), ", ".join(path.name for path in each.files)) for each in self.exports]


def _as_data(each: Exported) -> dict[str, Any]:
    return {
        "name": each.name,
        "outcome": asdict(each.outcome),
        "files": [str(path) for path in each.files],
        "made": [asdict(outcome) for outcome in each.made],
        "legible": each.legible and each.legible.as_data(),
    }


def chosen_exporters(
    config: PipelineConfig, to: Sequence[str | Exporter] | None, registry: Registry
) -> tuple[NamedMethod[Exporter], ...]:
    """The exporters that are named, with the options that the configuration gives them; without names, all of its own.

    Raises: ConfigError if there are none; ArgumentError for what is neither name nor exporter; UnknownMethod,
    BrokenMethod; ConfigError for one whose options must be given.
    """
    if to is None:
        found = config.export
    else:
        to = [to] if isinstance(to, str | Exporter) else to
        found = tuple(chosen for each in to for chosen in _chosen(config, each, registry))
    if not found:
        known = ", ".join(registry.names("export"))
        raise ConfigError(f"no exporter is named; name some, `--to NAMES` or `export: [NAMES]`; installed: {known}")
    return found


def _chosen(config: PipelineConfig, each: str | Exporter, registry: Registry) -> tuple[NamedMethod[Exporter], ...]:
    if isinstance(each, Exporter):
        return (NamedMethod(type(each).__qualname__, "", each),)
    if not isinstance(each, cast(Any, str)):
        raise wrong_argument("to", each, "the name of an exporter, or an object of one")
    if own := tuple(chosen for chosen in config.export if chosen.name == each):
        return own
    listing, cls = registry.find("export", each), cast("type[Exporter]", registry.load("export", each))
    try:
        return (NamedMethod(each, listing.origin, cls()),)
    except ValueError as error:
        raise ConfigError(f"export: {each} has options that must be given; list it under `export:`") from error


def export(
    engine: Engine,
    folder: Path,
    chosen: Sequence[NamedMethod[Exporter]],
    progress: Progress | None = None,
    stop: Event | None = None,
    *,
    force: bool = False,
) -> Export:
    """Have each exporter write its files into a folder. What one cannot write does not keep the others from it.

    Raises: OutputError if the folder cannot be written; TangibleError for a scene that cannot be read; Stopped.
    """
    stem = stem_of(engine.config, engine.scene)
    check_writable(folder)
    desk, done = _Desk(engine, folder, force, progress or _unheard), list[Exported]()
    with stoppable(stop):
        for name, number, each in _numbered(chosen):
            done.append(desk.serve(name, stem if number == 1 else f"{stem}-{number}", each))
    return Export(folder, tuple(done))


def _numbered(chosen: Iterable[NamedMethod[Exporter]]) -> Iterable[tuple[str, int, NamedMethod[Exporter]]]:
    """Each with a name of its own, and how many of its name there are so far."""
    seen = Counter[str]()
    for each in chosen:
        seen[each.name] += 1
        number = seen[each.name]
        yield each.name if number == 1 else f"{each.name}-{number}", number, each


@final
class _Desk:
    """One call of `export`: what was made for one exporter is there for the next."""

    def __init__(self, engine: Engine, folder: Path, force: bool, progress: Progress) -> None:
        self.engine = engine
        self.folder = folder
        self.force = force
        self.progress = progress
        self.source = relative_source(engine.config.path, folder)
        self.of_width: dict[float | None, Engine] = {None: engine, engine.config.size.width_m: engine}

    def serve(self, name: str, stem: str, chosen: NamedMethod[Exporter]) -> Exported:
        """Make what this exporter needs, and have it write."""
        made, product, seconds = Outcomes(), f"{PREFIX}{name}", 0.0
        files, legible, notes = (), None, list[Note]()

        def told(stage: StageEvent) -> None:
            if stage.outcome is not None:
                made.append(stage.outcome)
            self.progress(stage)

        try:
            engine = self._engine(chosen)
            with engine.watching(told):
                work = work_for(engine, chosen.method)
                legible = legible_for(engine, chosen.method)
            check_stopped()
            self.progress(StageEvent(product, chosen.name))
            hooks.tell(self.engine.registry.plugins, "tangible_stage_started", product=product, method=chosen.name)
            start = perf_counter()
            with scratch(self.folder) as place, collect_notes() as notes:
                files = self._written(chosen, work, place / stem)
            seconds = perf_counter() - start
            became: OutcomeKind = "ran"
            notes = [*_illegible(legible), *notes]
            why = "; ".join(["asked for", *(each.text for each in notes)])
        except Stopped:
            raise
        except (Exception, SystemExit) as error:  # noqa: BLE001 - whatever a plugin raises, the others still write
            became, why = _fault(error, self.folder)
        outcome = Outcome(product, became, why, chosen.name, seconds, tuple(notes))
        self.progress(StageEvent(product, chosen.name, outcome))
        hooks.tell(self.engine.registry.plugins, "tangible_stage_finished", outcome=outcome)
        return Exported(name, outcome, files, made, legible)

    def _engine(self, chosen: NamedMethod[Exporter]) -> Engine:
        """The one that makes products as wide as this exporter writes them."""
        rows, columns = self.engine.scene.shape
        width_m = chosen.method.picture_width_m(columns / rows)
        if width_m not in self.of_width:
            self.of_width[width_m] = of_width(self.engine, width_m)
        found = self.of_width[width_m]
        for other in self.of_width.values():
            found.adopt(other)
        return found

    def _written(self, chosen: NamedMethod[Exporter], work: Work, stem: Path) -> tuple[Path, ...]:
        cls = type(chosen.method)
        written = chosen.method.write(work, stem)
        check_stopped()
        found = check_written(written, stem, plugin_name("export", cls.__module__, cls.__qualname__))
        return move(found, self.folder, self.source, chosen.name, self.force)


def work_for(engine: Engine, exporter: Exporter) -> Work:
    """What an exporter is given: the products that it needs, made as finely as they are felt.

    Raises: BrokenMethod for a product that nothing makes; TangibleError as `Engine.make`.
    """
    if odd := [each for each in exporter.needs if each not in EXPORTABLE]:
        who = plugin_name("export", type(exporter).__module__, type(exporter).__qualname__)
        raise BrokenMethod(f"{who}: needs {quoted(odd[0])}; an exporter may need {', '.join(EXPORTABLE)}")
    products: dict[str, Record | None] = {name: engine.make_on_grid(name) for name in exporter.needs}
    views = engine.scene.views
    return Work(
        title_of(engine.config, engine.scene),
        engine.config.language,
        products,
        None if views is None else views.left,
        names(engine.config, products),
        {"views": views, "truth": engine.scene.truth},
    )


def legible_for(engine: Engine, exporter: Exporter) -> Legibility | None:
    """Whether fingers can read what it writes, by what is made for it anyway; None for what is not felt."""
    if exporter.medium is None:
        return None
    parts = "simplified" if "simplified" in exporter.needs else engine.config.felt_parts
    return judged(engine, exporter.medium, parts, set[str]().union(*map(engine.inputs_of, exporter.needs)))


def _illegible(legible: Legibility | None) -> list[Note]:
    if legible is None or legible.readable:
        return []
    log.warning("%s", legible.sentence)
    return [Note(legible.sentence, "warning")]


def title_of(config: PipelineConfig, scene: Scene) -> str:
    """What an exporter calls it: its title, or else the name of its scene, without folder and ending."""
    if config.title.strip():
        return config.title.strip()
    name = Path(scene.name)
    return name.stem if isinstance(scene.files, SceneFiles) else name.name


def stem_of(config: PipelineConfig, scene: Scene) -> str:
    """How the names of files begin: as that of the pipeline file, or of the scene; without a dot, which begins an
    ending.

    >>> stem_of(PipelineConfig(scene="builtin/coins", path=Path("maps/harbour.v2.yaml")), Scene("coins"))
    'harbour-v2'
    """
    name = title_of(config, scene) if config.path is None else default_name(config.path)
    plain = re.sub(r"[^\w -]+", "-", name).strip("- ")
    return plain.encode()[:MOST_STEM_BYTES].decode(errors="ignore") or "export"


def _fault(error: BaseException, folder: Path) -> tuple[OutcomeKind, str]:
    """What became of an exporter that raised this, and the words for it."""
    if isinstance(error, SystemExit):
        return "failed", str(exit_error(error))
    if isinstance(error, TangibleError):
        return "failed" if isinstance(error, BrokenMethod) else "refused", str(error)
    if isinstance(error, OSError) and error.errno in NO_ROOM:
        said = f"{folder}: cannot be written: {error.strerror}; free some space or choose another folder"
        return "refused", said
    return "failed", failures.sentence(error)


def _unheard(stage: StageEvent) -> None:
    """Nobody listens."""
