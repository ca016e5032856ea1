"""The engine: it makes a requested product and only what that needs, and reports the outcome of each product."""

import logging
from collections.abc import Callable, Container, Generator, Iterable, Mapping
from contextlib import contextmanager
from copy import copy
from functools import cached_property
from threading import Event
from time import perf_counter
from typing import Any, NamedTuple

from ...compiled.background import BackgroundCompiler
from ...data import Note, Outcome, Outcomes, Plan, Record
from ...data.products import PRODUCTS
from ...errors import TangibleError, UnknownMethod
from ...plugins import hooks
from ...plugins.interfaces import HapticDevice
from ...plugins.notes import collect_notes
from ...plugins.registry import Registry
from ...runtime.stopping import check_stopped, stoppable
from ...runtime.threads import check_threads, limited_threads
from ...scene.scene import Scene
from ..config.methods import NamedMethod
from ..config.model import PipelineConfig
from .cache import Cache, Notes
from .keys import product_key
from .stage import Context, Stage, stage_class

log = logging.getLogger(__name__)


class StageEvent(NamedTuple):
    """The begin of a stage, or its outcome."""

    product: str
    method: str
    outcome: Outcome | None = None
    """None at the begin."""


Progress = Callable[[StageEvent], None]
"""A listener, called at the begin and the end of every stage in the thread that makes it."""


class Engine:
    """A scene, a configuration, and the products that were made of them so far."""

    def __init__(self, config: PipelineConfig, registry: Registry, cache: Cache | None = None) -> None:
        self.config = config
        self.registry = registry
        self.cache = cache
        self.threads: int | None = None
        """The most threads that work at once; None for no limit but that of `TANGIBLE_THREADS`."""
        self.beside: BackgroundCompiler | None = None
        """A process that compiles in the background; a stage waits for what is compiled for it."""
        self.begun: set[str] = set()
        """The products whose making has begun."""
        self._made: dict[str, Any] = {}
        self._finished: dict[str, Any] = {}
        self._full_size: dict[str, Any] = {}
        self._keys: dict[str, str] = {}
        self._outcomes: dict[str, Outcome] = {}
        self._notes: dict[str, tuple[Note, ...]] = {}
        """The notes on each product from when it was made, in this process or before."""
        self._substituted: frozenset[str] = frozenset()
        """The products that another engine handed over, and all that is made of them: they are not kept or reported."""
        self._progress: Progress = _ignore

    def limit_threads(self, most: int | None) -> None:
        """Let at most so many threads work at once, of kernels, OpenCV and torch; no result depends on it.

        most: None for one a processor, or what the environment variable `TANGIBLE_THREADS` says.
        Raises: ConfigError for less than one.
        """
        check_threads(most)
        self.threads = most

    @contextmanager
    def watched(self, progress: Progress | None = None, stop: Event | None = None) -> Generator[None]:
        """Report what is made in this block to `progress`; it ends with `Stopped` soon after `stop` is set."""
        before, self._progress = self._progress, progress or self._progress
        try:
            with stoppable(stop):
                yield
        finally:
            self._progress = before

    @property
    def outcomes(self) -> Outcomes:
        """The outcome of each product, in the order of making; last the products that nothing needed."""
        left = (stage for product, stage in self._stages.items() if product not in self._outcomes and stage.listed)
        return Outcomes([*self._outcomes.values(), *map(self._not_needed, left)])

    def _not_needed(self, stage: Stage) -> Outcome:
        notes = self._notes.get(stage.product, ())
        why = _with(notes, WITHIN_CACHED) if notes else NOT_NEEDED
        return Outcome(stage.product, "skipped", why, stage.method, notes=notes)

    @cached_property
    def scene(self) -> Scene:
        """The scene, read from its files. Raises: PictureError, GeometryError."""
        return self._read[0]

    @cached_property
    def _read(self) -> tuple[Scene, tuple[Note, ...]]:
        """The scene, and the notes from reading it."""
        if isinstance(self.config.scene, Scene):
            return self.config.scene, tuple(map(Note, self.config.scene.notes))
        with collect_notes() as notes:
            scene = Scene.read(self.config.scene, self.config.folder)
        return scene, (*notes, *map(Note, scene.notes))

    @cached_property
    def brought(self) -> Mapping[str, Record]:
        """The products that the scene provides, by name."""
        start, size = perf_counter(), self.config.size
        products = self.scene.brings(size.width_m, size.relief_m, size.holes, size.finest_m)
        for product in products:
            why, notes = self._provided(product)
            self._note(Outcome(product, "given", why, "", perf_counter() - start, notes))
            start = perf_counter()
        self._made |= products
        return products

    def plan(self, want: str | None = None) -> Plan:
        """Return what making a product would do; nothing runs.

        Raises: TangibleError for a scene that cannot be read; UnknownMethod for a product that nothing makes.
        """
        want = self._product(want)
        plan = Plan(want, tuple(self._foresee(want, REQUESTED, {}).values()))
        hooks.tell(self.registry.plugins, "tangible_plan_made", plan=plan)
        return plan

    def check(self, want: str | None = None) -> None:
        """Plan, and raise the plan's refusal, if any."""
        for step in self.plan(want).steps:
            refusal = self._stages[step.product].refusal if step.outcome == "refused" else None
            if refusal is not None:
                raise refusal

    def make(self, want: str | None = None) -> Any:
        """Make a product from what it needs and no more; None if this scene does not need it.

        Disparity, segments and parts have a value for every pixel of the pictures, even where they were made smaller
        (`on_grid`).
        Raises: TangibleError for what a user can correct; whatever a plugin raises.
        """
        product = self._product(want)
        value, stage = self._pull(product, REQUESTED), self._stages.get(product)
        if value is None or stage is None:
            return value
        if product not in self._full_size:
            self._full_size[product] = stage.full_size(value)
        return self._full_size[product]

    def felt(self, product: str) -> Any:
        """Make a product as `make` does, but on the working grid; a scene's own product keeps its size."""
        return self._pull(product, REQUESTED)

    def with_products(self, **products: Record) -> "Engine":
        """Return a copy in which these products are as given, whatever makes them here.

        Whatever does not depend on them is shared: it is not made again. What does is made anew when it is requested,
        neither cached nor reported to hooks, so that a copy a frame or a step of a slider costs nothing else.
        """
        other = copy(self)
        other.brought = {**self.brought, **products}
        context = Context(self.config, self.scene, other.brought)
        anew = {name for name in self._stages if self._depends_on(name, products)}
        other._stages = {
            name: stage_class(name)(context) if name in anew else stage
            for name, stage in self._stages.items()
            if name not in products
        }
        other._substituted = self._substituted | anew | products.keys()
        other.begun, other.beside, other._progress = set(), None, _ignore
        for each in ("_made", "_finished", "_full_size", "_keys", "_outcomes", "_notes"):
            kept = {name: value for name, value in getattr(self, each).items() if name not in other._substituted}
            setattr(other, each, kept)
        other._made |= products
        return other

    def _depends_on(self, name: str, products: Container[str]) -> bool:
        """Return True for these products and for all that is made of them."""
        stage = self._stages.get(name)
        return name in products or (stage is not None and any(self._depends_on(each, products) for each in stage.needs))

    def touch_on(self, device: HapticDevice) -> Any:
        """Make a touch for a device that the configuration does not name; all else is shared. Raises: as `make`."""
        other = copy(self)
        other.config = self.config.with_values(device=NamedMethod("", "", device))
        other.__dict__.pop("_stages", None)
        for each in ("_made", "_finished", "_full_size"):
            setattr(other, each, {product: made for product, made in getattr(self, each).items() if product != "touch"})
        touch = other.make("touch")
        self._made |= {product: made for product, made in other._made.items() if product != "touch"}
        return touch

    def with_config(self, config: PipelineConfig) -> "Engine":
        """Return an engine of another configuration, which takes over the products that it would make alike."""
        other = Engine(config, self.registry, self.cache)
        other.threads = self.threads
        if config.scene == self.config.scene:
            other._read = self._read
        other.adopt(self)
        return other

    def adopt(self, other: "Engine") -> None:
        """Take over the products that another configuration of the same scene made alike."""
        if other.config.scene == self.config.scene and "_stages" in other.__dict__:
            alike = [name for name in other._made if name in other._stages and other._stages[name].cached]
            new = (name for name in alike if name not in self._made)
            self._made |= {name: other._made[name] for name in new if self.key(name) == other.key(name)}

    def needed(self, want: str) -> set[str]:
        """Return the product and everything that it is made from."""
        stage = self._stages.get(want)
        return {want}.union(*map(self.needed, stage.needs)) if stage and not stage.skip else {want}

    def key(self, product: str) -> str:
        """Return a text that stands for the product's content, and is known before it is made."""
        if product not in self._keys:
            self._keys[product] = self._key(product)
        return self._keys[product]

    def _key(self, product: str) -> str:
        stage = self._stages.get(product)
        if stage is None:
            value = self.brought.get(product)
            return "nothing" if value is None else value.digest()
        if stage.skip:
            return "skipped"
        return product_key(product, stage.key, {name: self.key(name) for name in stage.needs})

    def _pull(self, product: str, why: str) -> Any:
        if product not in self._made and product in self._stages:
            self._made[product] = self._make(self._stages[product], why)
        return self._finish(product)

    def _finish(self, product: str) -> Any:
        """Return what was made, finished by its stage."""
        value, stage = self._made.get(product), self._stages.get(product)
        if value is None or stage is None:
            return value
        if product not in self._finished:
            try:
                self._finished[product] = stage.finish(value)
            except TangibleError as error:
                self._note(Outcome(product, "failed", str(error), stage.method))
                raise
        return self._finished[product]

    def _make(self, stage: Stage, why: str) -> Any:
        if stage.skip:
            self._note(Outcome(stage.product, "skipped", stage.skip, stage.method))
            return None
        if (found := self._from_cache(stage)) is not None:
            return found
        if stage.refusal is not None:
            self._note(Outcome(stage.product, "refused", str(stage.refusal), stage.method))
            raise stage.refusal
        inputs = {name: self._pull(name, f"{NEEDED} {stage.product}") for name in stage.needs}
        check_stopped()
        self._progress(StageEvent(stage.product, stage.method))
        if stage.product not in self._substituted:
            hooks.tell(self.registry.plugins, "tangible_stage_started", product=stage.product, method=stage.method)
        self.begun.add(stage.product)
        if self.beside is not None:
            self.beside.wait(stage.product)
        start = perf_counter()
        try:
            with collect_notes() as notes, limited_threads(self.threads):
                value = stage.make(inputs)
        except BaseException as error:
            failure = f"{type(error).__name__}: {error}"
            self._note(Outcome(stage.product, "failed", failure, stage.method, perf_counter() - start))
            raise
        seconds = perf_counter() - start
        self._notes[stage.product] = all_notes = (*_notes_ahead(stage), *notes)
        self._note(Outcome(stage.product, "ran", _with(all_notes, why), stage.method, seconds, all_notes))
        if self.cache is not None and self._is_cached(stage):
            within = {name: self._notes[name] for name in sorted(self.needed(stage.product)) if self._notes.get(name)}
            self.cache.put(self.key(stage.product), value, within)
        return value

    def _from_cache(self, stage: Stage) -> Record | None:
        if self.cache is None or not self._is_cached(stage):
            return None
        start = perf_counter()
        entry = self.cache.entry(self.key(stage.product))
        if entry is None:
            return None
        self._repeat_notes(entry.notes)
        notes = self._notes.get(stage.product, ())
        self._note(Outcome(stage.product, "cached", _with(notes, SAME), stage.method, perf_counter() - start, notes))
        return entry.record

    def _is_cached(self, stage: Stage) -> bool:
        return stage.cached and stage.product not in self._substituted

    def _repeat_notes(self, kept: Notes) -> None:
        """Take over the notes on products that come from the cache or are within one that does; log warnings again."""
        for product in kept.keys() - self._notes.keys():
            self._notes[product] = kept[product]
            for each in kept[product]:
                if each.kind != "decision":
                    log.warning("%s", each.text)

    def _foresee(self, product: str, why: str, steps: dict[str, Outcome]) -> dict[str, Outcome]:
        """Add the outcomes of a product and, before it, of what it needs."""
        stage = self._stages.get(product)
        if product in steps:
            return steps
        if stage is None:
            if product in self.brought:
                why, notes = self._provided(product)
                steps[product] = Outcome(product, "given", why, notes=notes)
        elif stage.skip:
            steps[product] = Outcome(product, "skipped", stage.skip, stage.method)
        elif self.cache is not None and self._is_cached(stage) and self.key(product) in self.cache:
            notes = _notes_within(self.cache.notes(self.key(product)), product)
            steps[product] = Outcome(product, "cached", _with(notes, SAME), stage.method, notes=notes)
        elif stage.refusal is not None:
            steps[product] = Outcome(product, "refused", str(stage.refusal), stage.method)
        else:
            for name in stage.needs:
                self._foresee(name, f"{NEEDED} {product}", steps)
                if any(each.outcome == "refused" for each in steps.values()):
                    return steps
            notes = _notes_ahead(stage)
            steps[product] = Outcome(product, "ran", _with(notes, why), stage.method, notes=notes)
        return steps

    def _provided(self, product: str) -> tuple[str, tuple[Note, ...]]:
        """Return why a product is given; with the pictures or the heights, the notes on their files too."""
        scene, noticed = self._read
        notes = noticed if product == ("relief" if scene.views is None else "views") else ()
        return _with(notes, f"provided by the scene {scene.name}"), notes

    @cached_property
    def _stages(self) -> dict[str, Stage]:
        """The stages of all products that the scene does not provide. Raises: ConfigError, MaterialError."""
        context = Context(self.config, self.scene, self.brought)
        return {name: stage_class(name)(context) for name in PRODUCTS if name not in self.brought}

    def _product(self, want: str | None) -> str:
        product = want or self.config.want
        if product not in PRODUCTS:
            raise UnknownMethod("product", product, PRODUCTS)
        return product

    def _note(self, outcome: Outcome) -> None:
        self._outcomes[outcome.product] = outcome
        self._progress(StageEvent(outcome.product, outcome.method, outcome))
        if outcome.product not in self._substituted:
            hooks.tell(self.registry.plugins, "tangible_stage_finished", outcome=outcome)


def _ignore(event: StageEvent) -> None:
    """Do nothing: there is no listener."""


def _notes_ahead(stage: Stage) -> tuple[Note, ...]:
    return (Note(stage.note),) if stage.note else ()


def _notes_within(kept: Notes, product: str) -> tuple[Note, ...]:
    """Return the notes on a cached product, and the warnings and doubts on the products that it was made from."""
    within = (each for name in sorted(kept) if name != product for each in kept[name] if each.kind != "decision")
    return (*kept.get(product, ()), *within)


def _with(notes: Iterable[Note], why: str) -> str:
    return "; ".join([why, *(each.text for each in notes)])


REQUESTED = "requested"
NEEDED = "needed for"
NOT_NEEDED = "not needed for what was requested"
WITHIN_CACHED = "within a cached product"
SAME = "same method, options and inputs as before"
