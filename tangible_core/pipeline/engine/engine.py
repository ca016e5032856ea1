"""Pull: ask for a product, and only what it needs is made; each product says what became of it."""

import logging
from collections.abc import Callable, Generator, Iterable, Mapping
from contextlib import contextmanager
from copy import copy
from functools import cached_property
from threading import Event
from time import perf_counter
from typing import Any, NamedTuple

from ...compiled.beside import Beside
from ...data import Note, Outcome, Outcomes, Plan, Record
from ...errors import TangibleError, UnknownMethod
from ...plugins import hooks
from ...plugins.interfaces import HapticDevice
from ...plugins.notes import noted
from ...plugins.registry import Registry
from ...runtime.stopping import check_stopped, stoppable
from ...runtime.threads import limited_threads
from ...scene.scene import Scene
from ..config.methods import NamedMethod
from ..config.model import PRODUCTS, PipelineConfig
from .cache import Cache, Notes
from .rules import Rule, given_key, made_key, rules

log = logging.getLogger(__name__)


class Stage(NamedTuple):
    """A product that is being made, or what became of it."""

    product: str
    method: str
    outcome: Outcome | None = None
    """None when it begins."""


Progress = Callable[[Stage], None]
"""Hears of every stage when it begins and when it ends, in the thread that makes it."""


class Engine:
    """One scene, one configuration, and what was made of them so far."""

    def __init__(self, config: PipelineConfig, registry: Registry, cache: Cache | None = None) -> None:
        self.config = config
        self.registry = registry
        self.cache = cache
        self.threads: int | None = None
        """The most that work at once; None for no limit but that of `TANGIBLE_THREADS`."""
        self.beside: Beside | None = None
        """What compiles meanwhile; a stage waits for what it compiles for it."""
        self.begun: set[str] = set()
        """Products that were begun to be made."""
        self._made: dict[str, Any] = {}
        self._finished: dict[str, Any] = {}
        self._whole: dict[str, Any] = {}
        self._keys: dict[str, str] = {}
        self._outcomes: dict[str, Outcome] = {}
        self._notes: dict[str, tuple[Note, ...]] = {}
        """What was noticed of each product when it was made, in this process or before."""
        self._progress: Progress = _unheard

    @contextmanager
    def watched(self, progress: Progress | None = None, stop: Event | None = None) -> Generator[None]:
        """What is made in this block is told to `progress`, and ends with `Stopped` soon after `stop` is set."""
        before, self._progress = self._progress, progress or self._progress
        try:
            with stoppable(stop):
                yield
        finally:
            self._progress = before

    @property
    def outcomes(self) -> Outcomes:
        """What became of each product, in the order of making; last those that nothing needed."""
        left = (rule for product, rule in self._rules.items() if product not in self._outcomes and rule.usual)
        unasked = [self._unasked(rule) for rule in left]
        return Outcomes([*self._outcomes.values(), *unasked])

    def _unasked(self, rule: Rule) -> Outcome:
        notes = self._notes.get(rule.product, ())
        why = _with(notes, EARLIER) if notes else "nothing that was asked for needs it"
        return Outcome(rule.product, "skipped", why, rule.method, notes=notes)

    @cached_property
    def scene(self) -> Scene:
        """The scene, read from its files. Raises: PictureError, GeometryError."""
        return self._read[0]

    @cached_property
    def _read(self) -> tuple[Scene, tuple[Note, ...]]:
        """The scene, and what was noticed when it was read."""
        if isinstance(self.config.scene, Scene):
            return self.config.scene, tuple(map(Note, self.config.scene.notes))
        with noted() as notes:
            scene = Scene.read(self.config.scene, self.config.folder)
        return scene, (*notes, *map(Note, scene.notes))

    @cached_property
    def brought(self) -> Mapping[str, Record]:
        """The products that the scene brings, by name."""
        start, size = perf_counter(), self.config.size
        found = self.scene.brings(size.width_m, size.relief_m, size.holes, size.finest_m)
        for product in found:
            why, notes = self._bringing(product)
            self._note(Outcome(product, "given", why, "", perf_counter() - start, notes))
            start = perf_counter()
        self._made |= found
        return found

    def plan(self, want: str | None = None) -> Plan:
        """What asking for a product will do; nothing is run.

        Raises: TangibleError for a scene that cannot be read; UnknownMethod for a product that nothing makes.
        """
        want = self._product(want)
        plan = Plan(want, tuple(self._foresee(want, ASKED, {}).values()))
        hooks.tell(self.registry.plugins, "tangible_plan_made", plan=plan)
        return plan

    def check(self, want: str | None = None) -> None:
        """Plan, and raise what the plan says is refused."""
        for step in self.plan(want).steps:
            refusal = self._rules[step.product].refusal if step.outcome == "refused" else None
            if refusal is not None:
                raise refusal

    def make(self, want: str | None = None) -> Any:
        """The product, made from what it needs and no more; None if this scene does not need it.

        Disparity, segments and parts are told for every pixel of the pictures, even where they were made smaller
        (`felt`).
        Raises: TangibleError for what a user can put right; whatever a plugin raises.
        """
        product = self._product(want)
        found, rule = self._pull(product, ASKED), self._rules.get(product)
        if found is None or rule is None or rule.whole is None:
            return found
        if product not in self._whole:
            self._whole[product] = rule.whole(found)
        return self._whole[product]

    def felt(self, product: str) -> Any:
        """The product as `make` gives it, but as finely as it is felt; that of a scene is as the scene brings it."""
        return self._pull(product, ASKED)

    def touch_on(self, device: HapticDevice) -> Any:
        """A touch for a device that the configuration does not name; all else is shared. Raises: as `make`."""
        other = copy(self)
        other.config = self.config.changed(device=NamedMethod("", "", device))
        other.__dict__.pop("_rules", None)
        other._made = {product: made for product, made in self._made.items() if product != "touch"}
        touch = other.make("touch")
        self._made |= {product: made for product, made in other._made.items() if product != "touch"}
        return touch

    def changed(self, config: PipelineConfig) -> "Engine":
        """Another configuration of the same; products that it makes alike are those of this one."""
        other = Engine(config, self.registry, self.cache)
        other.threads = self.threads
        if config.scene == self.config.scene:
            other._read = self._read
        other.adopt(self)
        return other

    def adopt(self, other: "Engine") -> None:
        """Products that another configuration of the same scene made alike need not be made again."""
        if other.config.scene == self.config.scene and "_rules" in other.__dict__:
            alike = [name for name in other._made if name in other._rules and other._rules[name].cached]
            new = (name for name in alike if name not in self._made)
            self._made |= {name: other._made[name] for name in new if self.key(name) == other.key(name)}

    def needed(self, want: str) -> set[str]:
        """The product and everything that it is made from, by the rules."""
        rule = self._rules.get(want)
        return {want}.union(*(self.needed(name) for name in rule.needs)) if rule and not rule.skip else {want}

    def key(self, product: str) -> str:
        """What stands for the product's content: known before it is made."""
        if product not in self._keys:
            self._keys[product] = self._key(product)
        return self._keys[product]

    def _key(self, product: str) -> str:
        rule = self._rules.get(product)
        if rule is None:
            value = self.brought.get(product)
            return "nothing" if value is None else given_key(value)
        if rule.skip:
            return "skipped"
        return made_key(rule, {name: self.key(name) for name in rule.needs})

    def _pull(self, product: str, why: str) -> Any:
        if product not in self._made and product in self._rules:
            self._made[product] = self._make(self._rules[product], why)
        return self._finish(product)

    def _finish(self, product: str) -> Any:
        """What was made, with what its rule adds to it."""
        found, rule = self._made.get(product), self._rules.get(product)
        if found is None or rule is None or rule.finish is None:
            return found
        if product not in self._finished:
            try:
                self._finished[product] = rule.finish(found)
            except TangibleError as error:
                self._note(Outcome(product, "failed", str(error), rule.method))
                raise
        return self._finished[product]

    def _make(self, rule: Rule, why: str) -> Any:
        if rule.skip:
            self._note(Outcome(rule.product, "skipped", rule.skip, rule.method))
            return None
        if (found := self._from_cache(rule)) is not None:
            return found
        if rule.refusal is not None:
            self._note(Outcome(rule.product, "refused", str(rule.refusal), rule.method))
            raise rule.refusal
        inputs = {name: self._pull(name, f"{rule.product} is made from it") for name in rule.needs}
        check_stopped()
        self._progress(Stage(rule.product, rule.method))
        hooks.tell(self.registry.plugins, "tangible_stage_started", product=rule.product, method=rule.method)
        self.begun.add(rule.product)
        if self.beside is not None:
            self.beside.wait(rule.product)
        start = perf_counter()
        try:
            with noted() as notes, limited_threads(self.threads):
                value = rule.make(inputs)
        except BaseException as error:
            failure = f"{type(error).__name__}: {error}"
            self._note(Outcome(rule.product, "failed", failure, rule.method, perf_counter() - start))
            raise
        seconds = perf_counter() - start
        self._notes[rule.product] = found = (*_foreseen(rule), *notes)
        self._note(Outcome(rule.product, "ran", _with(found, why), rule.method, seconds, found))
        if self.cache is not None and rule.cached:
            within = {name: self._notes[name] for name in sorted(self.needed(rule.product)) if self._notes.get(name)}
            self.cache.put(self.key(rule.product), value, within)
        return value

    def _from_cache(self, rule: Rule) -> Record | None:
        if self.cache is None or not rule.cached:
            return None
        start = perf_counter()
        entry = self.cache.entry(self.key(rule.product))
        if entry is None:
            return None
        self._tell_again(entry.notes)
        notes = self._notes.get(rule.product, ())
        self._note(Outcome(rule.product, "cached", _with(notes, SAME), rule.method, perf_counter() - start, notes))
        return entry.record

    def _tell_again(self, kept: Notes) -> None:
        """Notes of products that come from the cache, or are within one that does; warnings are logged as at first."""
        for product in kept.keys() - self._notes.keys():
            self._notes[product] = kept[product]
            for each in kept[product]:
                if each.kind != "decision":
                    log.warning("%s", each.text)

    def _foresee(self, product: str, why: str, steps: dict[str, Outcome]) -> dict[str, Outcome]:
        """Outcomes of a product and, before it, of what it needs."""
        rule = self._rules.get(product)
        if product in steps:
            return steps
        if rule is None:
            if product in self.brought:
                why, notes = self._bringing(product)
                steps[product] = Outcome(product, "given", why, notes=notes)
        elif rule.skip:
            steps[product] = Outcome(product, "skipped", rule.skip, rule.method)
        elif self.cache is not None and rule.cached and self.key(product) in self.cache:
            notes = _foretold(self.cache.notes(self.key(product)), product)
            steps[product] = Outcome(product, "cached", _with(notes, SAME), rule.method, notes=notes)
        elif rule.refusal is not None:
            steps[product] = Outcome(product, "refused", str(rule.refusal), rule.method)
        else:
            for name in rule.needs:
                self._foresee(name, f"{product} is made from it", steps)
                if any(each.outcome == "refused" for each in steps.values()):
                    return steps
            notes = _foreseen(rule)
            steps[product] = Outcome(product, "ran", _with(notes, why), rule.method, notes=notes)
        return steps

    def _bringing(self, product: str) -> tuple[str, tuple[Note, ...]]:
        """Why it is given; with the pictures or the heights, what was noticed in their files."""
        scene, noticed = self._read
        notes = noticed if product == ("relief" if scene.views is None else "views") else ()
        return _with(notes, f"the scene {scene.name} brings it"), notes

    @cached_property
    def _rules(self) -> dict[str, Rule]:
        return rules(self.config, self.scene, self.brought)

    def _product(self, want: str | None) -> str:
        product = want or self.config.want
        if product not in PRODUCTS:
            raise UnknownMethod("product", product, PRODUCTS)
        return product

    def _note(self, outcome: Outcome) -> None:
        self._outcomes[outcome.product] = outcome
        self._progress(Stage(outcome.product, outcome.method, outcome))
        hooks.tell(self.registry.plugins, "tangible_stage_finished", outcome=outcome)


def _unheard(stage: Stage) -> None:
    """Nobody listens."""


def _foreseen(rule: Rule) -> tuple[Note, ...]:
    return (Note(rule.note),) if rule.note else ()


def _foretold(kept: Notes, product: str) -> tuple[Note, ...]:
    """Notes of a product in the cache, and what is not only a decision of those that it was made from."""
    within = (each for name in sorted(kept) if name != product for each in kept[name] if each.kind != "decision")
    return (*kept.get(product, ()), *within)


def _with(notes: Iterable[Note], why: str) -> str:
    return "; ".join([why, *(each.text for each in notes)])


ASKED = "asked for"
EARLIER = "within what comes from the cache"
SAME = "same method, options and inputs as before"
