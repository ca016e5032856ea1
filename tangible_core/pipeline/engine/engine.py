"""The engine: it makes a requested product and only what that needs, and reports the outcome of each product."""

import logging
from collections import defaultdict
from collections.abc import Generator, Mapping
from contextlib import contextmanager
from copy import copy
from functools import cached_property, partial
from threading import Event
from time import perf_counter
from typing import Any

from ...compiled.background import BackgroundCompiler
from ...data import Note, Outcome, Outcomes, Plan, Record, Relief
from ...data.products import PRODUCTS
from ...errors import TangibleError, UnknownName
from ...files.paths import without_folders
from ...plugins import hooks
from ...plugins.failures import naming_plugins
from ...plugins.interfaces import HapticDevice
from ...plugins.notes import collect_notes, note
from ...plugins.registry import Registry
from ...runtime.stopping import check_stopped, stoppable
from ...runtime.threads import check_threads, limited_threads
from ...scene.scene import Scene
from ...scene.workspace import flat_warning
from ..config.methods import NamedMethod
from ..config.model import PipelineConfig
from .cache import Cache
from .planning import (
    NOT_MADE,
    REQUESTED,
    SAME,
    Outlook,
    ProductEntry,
    depends_on,
    foresee,
    needed_for,
    not_needed,
    notes_ahead,
    with_notes,
)
from .stage import Context, Progress, Stage, StageEvent, ignore_event, product_key, stage_class

log: logging.Logger = logging.getLogger(__name__)


class Engine:
    """A scene, a configuration, and the products that were made of them so far."""

    def __init__(
        self, config: PipelineConfig, registry: Registry, cache: Cache | None = None, threads: int | None = None
    ) -> None:
        """Make nothing yet. Raises: ArgumentError for a number of threads below one."""
        check_threads(threads)
        self.config = config
        self.registry = registry
        self.cache = cache
        self.threads = threads
        """The most threads at once, on which no result depends; None for the limit of `TANGIBLE_THREADS`, if any."""
        self.compiler: BackgroundCompiler | None = None
        """A process that compiles in the background; a stage waits for what is compiled for it."""
        self.starts: set[str] = set()
        """The products whose making has begun."""
        self._entries: defaultdict[str, ProductEntry] = defaultdict(ProductEntry)
        self._outcomes: dict[str, Outcome] = {}
        """The outcome of each product, in the order in which they ended; products of the scene have one as well."""
        self.on_heights: list[Note] = []
        """Remarks on the scale of the heights that the scene provides."""
        self._own_products: frozenset[str] = frozenset()
        """The products of `with_products`, and all that is made of them: they are neither cached nor reported."""
        self._progress: Progress = ignore_event

    @contextmanager
    def watching(self, progress: Progress | None = None, stop: Event | None = None) -> Generator[None]:
        """Report what is made in this block to `progress`; it ends with `Stopped` soon after `stop` is set."""
        before, self._progress = self._progress, progress or self._progress
        try:
            with stoppable(stop):
                yield
        finally:
            self._progress = before

    @property
    def outcomes(self) -> Outcomes:
        """The outcome of each product, in the order in which a picture becomes a force."""
        idle_stages = (
            stage for product, stage in self.stages.items() if product not in self._outcomes and stage.in_outcomes
        )
        idle = (not_needed(stage, self._entries[stage.product].notes or ()) for stage in idle_stages)
        road = ("views", *PRODUCTS)
        return Outcomes(sorted([*self._outcomes.values(), *idle], key=lambda outcome: road.index(outcome.product)))

    @cached_property
    def scene(self) -> Scene:
        """The scene, read from its files. Raises: PictureError, GeometryError."""
        return self._read[0]

    @cached_property
    def _read(self) -> tuple[Scene, tuple[Note, ...]]:
        """The scene, and the notes from reading it."""
        source = self.config.scene
        with collect_notes() as notes:
            scene = source if isinstance(source, Scene) else Scene.read(source, self.config.folder)
        of_files = (Note(text, "warning" if text in scene.warnings else "decision") for text in scene.notes)
        return scene, (*notes, *of_files)

    @cached_property
    def scene_products(self) -> Mapping[str, Record]:
        """The products that the scene provides, by name."""
        start, size = perf_counter(), self.config.size
        with collect_notes() as self.on_heights:
            products = self.scene.brings(
                size.width_m, size.relief_m, size.holes, size.finest_m, size.rise, partial(note, log)
            )
            relief = products.get("relief")
            if isinstance(relief, Relief) and (text := flat_warning(relief, "heights")):
                note(log, text, logging.WARNING)
        for product in products:
            why, notes = self.describe_source(product)
            self._note(Outcome(product, "given", why, "", perf_counter() - start, notes))
            start = perf_counter()
        return products

    def plan(self, want: str | None = None) -> Plan:
        """Foresee the outcomes of making a product. Raises: TangibleError for an unreadable scene, UnknownName."""
        want = self._product(want)
        ahead = Outlook(self.stages, self.scene_products, self.describe_source, self.cache_for, self.key)
        plan = Plan(want, tuple(foresee(ahead, want, REQUESTED, {}).values()))
        hooks.tell(self.registry.plugins, "tangible_plan_made", plan=plan)
        return plan

    def check(self, want: str | None = None) -> None:
        """Plan, and raise the plan's refusal, if any."""
        for step in self.plan(want).steps:
            if step.outcome == "refused" and (refusal := self.stages[step.product].refusal):
                raise refusal

    def make(self, want: str | None = None) -> Any:
        """Make a product at the pictures' size from what it needs and no more; None if this scene does not need it."""
        product = self._product(want)
        value, stage, entry = self._pull(product, REQUESTED), self.stages.get(product), self._entries[product]
        if value is None or stage is None:
            return value
        if entry.full_size is NOT_MADE:
            entry.full_size = stage.full_size(value)
        return entry.full_size

    def make_on_grid(self, product: str) -> Any:
        """Make a product on the working grid; a product of the scene keeps its size. Raises: as `make`."""
        return self._pull(product, REQUESTED)

    def with_products(self, **products: Record) -> "Engine":
        """Return a copy with these products in place of those that stages make.

        All products that do not depend on them are shared. The dependent ones are made again on request, neither cached
        nor reported to hooks, so that a copy for each frame, or for each step of a slider, costs nothing else.
        """
        other = copy(self)
        other.scene_products = {**self.scene_products, **products}
        context = Context(self.config, self.scene, other.scene_products, self.registry)
        dependent = {name for name in self.stages if depends_on(self.stages, name, products)}
        other.stages = {
            name: stage_class(name)(context) if name in dependent else stage
            for name, stage in self.stages.items()
            if name not in products
        }
        other._own_products = self._own_products | dependent | products.keys()
        other.starts, other.compiler, other._progress = set(), None, ignore_event
        entries = {name: copy(entry) for name, entry in self._entries.items() if name not in other._own_products}
        other._entries = defaultdict(ProductEntry, entries)
        other._outcomes = {name: self._outcomes[name] for name in self._outcomes if name not in other._own_products}
        return other

    def touch_on(self, device: HapticDevice) -> Any:
        """Make a touch for a device other than the configured one; all other products are shared. Raises: as `make`."""
        config = self.config.with_values(device=NamedMethod("", "", device))
        stage = stage_class("touch")(Context(config, self.scene, self.scene_products, self.registry))
        return self._finish(stage, self._make(stage, REQUESTED))

    def with_config(self, config: PipelineConfig) -> "Engine":
        """Return an engine for another configuration, with the products that are the same for both."""
        other = Engine(config, self.registry, self.cache, self.threads)
        if config.scene == self.config.scene:
            other._read = self._read
        other.adopt(self)
        return other

    def adopt(self, other: "Engine") -> None:
        """Take over the products of another configuration of the same scene that have the same keys."""
        if other.config.scene != self.config.scene:
            return
        for name, entry in [*other._entries.items()]:  # a key may add the records of inputs
            new = entry.value is not NOT_MADE and self._entries[name].value is NOT_MADE
            if new and other.stages[name].cached and self.key(name) == other.key(name):
                self._entries[name].value = entry.value

    def all_inputs(self, want: str) -> set[str]:
        """Return the product and all products that it is made from, directly or indirectly."""
        stage = self.stages.get(want)
        return {want}.union(*map(self.all_inputs, stage.needs)) if stage and not stage.skip else {want}

    def key(self, product: str) -> str:
        """Return a text that identifies the product's content before it is made."""
        entry = self._entries[product]
        if entry.key is None:
            stage, value = self.stages.get(product), self.scene_products.get(product)
            if stage is None:
                entry.key = "nothing" if value is None else value.digest()
            elif stage.skip:
                entry.key = "skipped"
            else:
                entry.key = product_key(product, stage.key, {name: self.key(name) for name in stage.needs})
        return entry.key

    def _pull(self, product: str, why: str) -> Any:
        """Return a product, made if it is not there yet, and finished by its stage."""
        stage, entry = self.stages.get(product), self._entries[product]
        if stage is None:
            return self.scene_products.get(product)
        if entry.value is NOT_MADE:
            entry.value = self._make(stage, why)
        if entry.result is NOT_MADE:
            entry.result = self._finish(stage, entry.value)
        return entry.result

    def _finish(self, stage: Stage, value: Any) -> Any:
        """Return what a stage made, checked by it, and with names; None for a skipped product."""
        try:
            return None if value is None else stage.finish(value)
        except TangibleError as error:
            self._note(Outcome(stage.product, "failed", str(error), stage.method))
            raise

    def _make(self, stage: Stage, why: str) -> Any:
        if stage.skip:
            self._note(Outcome(stage.product, "skipped", stage.skip, stage.method))
            return None
        if (record := self._from_cache(stage)) is not None:
            return record
        if stage.refusal is not None:
            self._note(Outcome(stage.product, "refused", str(stage.refusal), stage.method))
            raise stage.refusal.with_traceback(None)  # it may be raised again
        inputs = {name: self._pull(name, needed_for(stage.product)) for name in stage.needs}
        check_stopped()
        self._progress(StageEvent(stage.product, stage.method))
        if stage.product not in self._own_products:
            hooks.tell(self.registry.plugins, "tangible_stage_started", product=stage.product, method=stage.method)
        self.starts.add(stage.product)
        if self.compiler is not None:
            self.compiler.wait(stage.product)
        start = perf_counter()
        try:
            with collect_notes() as notes, limited_threads(self.threads), naming_plugins():
                value = stage.make(inputs)
        except BaseException as error:
            why = f"{type(error).__name__}: {error}"
            self._note(Outcome(stage.product, "failed", why, stage.method, perf_counter() - start))
            raise
        seconds = perf_counter() - start
        self._entries[stage.product].notes = all_notes = (*notes_ahead(stage), *notes)
        self._note(Outcome(stage.product, "ran", with_notes(all_notes, why), stage.method, seconds, all_notes))
        if cache := self.cache_for(stage):
            names = sorted(self.all_inputs(stage.product))
            within = {name: notes for name in names if (notes := self._entries[name].notes)}
            cache.put(self.key(stage.product), value, within)
        return value

    def _from_cache(self, stage: Stage) -> Record | None:
        """Return a cached product with the notes on it and on what it was made from; warnings are logged again."""
        start, cache = perf_counter(), self.cache_for(stage)
        if not (cache and (entry := cache.entry(self.key(stage.product)))):
            return None
        for product, product_notes in entry.notes.items():
            if self._entries[product].notes is None:
                self._entries[product].notes = product_notes
                for text in (remark.text for remark in product_notes if remark.kind != "decision"):
                    log.warning("%s", text)
        notes, seconds = self._entries[stage.product].notes or (), perf_counter() - start
        self._note(Outcome(stage.product, "cached", with_notes(notes, SAME), stage.method, seconds, notes))
        return entry.record

    def cache_for(self, stage: Stage) -> Cache | None:
        """Return the cache for the product of a stage; None where it is not cached."""
        return self.cache if stage.cached and stage.product not in self._own_products else None

    def describe_source(self, product: str) -> tuple[str, tuple[Note, ...]]:
        """Return why a product is given, and for the pictures or the heights the notes on their files."""
        scene, of_files = self._read
        notes = of_files if product == ("relief" if scene.views is None else "views") else ()
        notes += tuple(self.on_heights) if product == "relief" else ()
        return with_notes(notes, f"provided by the scene {without_folders(scene.name)}"), notes

    @cached_property
    def stages(self) -> dict[str, Stage]:
        """The stages of all products that the scene does not provide. Raises: ConfigError, MaterialError."""
        context = Context(self.config, self.scene, self.scene_products, self.registry)
        return {name: stage_class(name)(context) for name in PRODUCTS if name not in self.scene_products}

    def _product(self, want: str | None) -> str:
        if (product := want or self.config.want) not in PRODUCTS:
            raise UnknownName("product", product, PRODUCTS)
        return product

    def _note(self, outcome: Outcome) -> None:
        self._outcomes[outcome.product] = outcome
        self._progress(StageEvent(outcome.product, outcome.method, outcome))
        if outcome.product not in self._own_products:
            hooks.tell(self.registry.plugins, "tangible_stage_finished", outcome=outcome)
