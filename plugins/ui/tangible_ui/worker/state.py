"""What lies on the worker's state, and what a job is."""

from collections.abc import Generator
from contextlib import contextmanager, suppress
from pathlib import Path
from threading import Event, Lock
from typing import Any, Protocol, final
from weakref import WeakKeyDictionary

from tangible_core.errors import Stopped
from tangible_core.pipeline.config.model import PipelineConfig
from tangible_core.pipeline.config.parsing import parse_config
from tangible_core.pipeline.engine.cache import Cache
from tangible_core.pipeline.engine.engine import StageEvent
from tangible_core.pipeline.pipeline import Pipeline
from tangible_core.plugins.registry import Registry, default_registry
from tangible_core.scene.scene_files import SceneFiles

NEVER = -1


Stamp = tuple[tuple[Path, int, int], ...]
"""Of files: when each was changed last, and its size."""


def stamp_of(config: PipelineConfig) -> Stamp:
    """Of the files of a scene that are there; none of a built-in one."""
    named = config.scene if isinstance(config.scene, SceneFiles) else ()
    paths = [config.folder / value for _, value in named if isinstance(value, Path)]
    found: list[tuple[Path, int, int]] = []
    for path in paths:
        with suppress(OSError, ValueError):
            told = path.stat()
            found.append((path, told.st_mtime_ns, told.st_size))
    return tuple(found)


class Tell(Protocol):
    """Says an event to all pages."""

    def __call__(self, event: str, **told: Any) -> None:
        """Its name, and what there is to know of it."""


@final
class Work:
    """What a long job is at: one stage after the other, until it is told to stop."""

    def __init__(self, pipeline: Pipeline) -> None:
        self.pipeline = pipeline
        self.stop = Event()
        self.worth = False
        """Whether there is something to see of it, even if the rest fails."""
        self._product = ""
        self._after = False

    def follow(self, stage: StageEvent) -> None:
        """A stage began or ended."""
        self._product = "" if stage.outcome else stage.product
        if stage.outcome and self._after:
            self.stop.set()

    def give_way(self, to: Pipeline, want: str) -> bool:
        """Stop for another pipeline: at once, or after a stage which that one needs too; whether at once."""
        product, needed = self._product, to.engine.needed(want)
        if product in needed and self.pipeline.engine.key(product) == to.engine.key(product):
            self._after = True
            return False
        self.stop.set()
        return True


@final
class WorkerState:
    """The last pipeline that became something to feel or to see, and the folder of what pages fetch.

    Long jobs and quick ones come from two threads. A pipeline that lies here is never worked on: a job works on
    another one, which shares what was made, and lays it here when it is done. One that fails leaves the last good one.
    """

    def __init__(self, folder: Path, tell: Tell, cache: Cache | None = None) -> None:
        """cache: where results are kept; the user's own by default."""
        self.folder, self.tell = folder, tell
        self.registry: Registry = default_registry()
        self.pipeline: Pipeline | None = None
        self.shown = ""
        """Digest of the surface that pages were told of last."""
        self.described: Any = None
        """The pipeline and what is seen of it, of which pages were told in words last."""
        self.opened: Any = None
        """What an editor of parts works on; quick jobs alone look at it."""
        self.kept: Any = None
        """What does not depend on the heights of parts; quick jobs alone look at it."""
        self._cache = cache or Cache()
        self._stamps: WeakKeyDictionary[Pipeline, Stamp] = WeakKeyDictionary()
        self._newest, self._work = NEVER, None
        self._parsed: tuple[Any, PipelineConfig] | None = None
        self._lock = Lock()

    def config_of(self, text: str, path: Path, sets: list[str]) -> PipelineConfig:
        """What a text says; the last one is remembered, as one edit asks for it three times. Raises: ConfigError."""
        asked = text, path, tuple(sets)
        if (parsed := self._parsed) is not None and parsed[0] == asked:
            return parsed[1]
        config = parse_config(text, path, self.registry, sets)
        self._parsed = asked, config
        return config

    def pipeline_of(self, text: str, path: Path, sets: list[str]) -> Pipeline:
        """The pipeline that a text says; what is alike in the last good one is not made again. Raises: ConfigError."""
        config, before = self.config_of(text, path, sets), self.pipeline
        made = self.after(before, config) if before is not None else None
        if made is None:
            made = Pipeline.from_config(config, self.registry, self._cache)
            self._stamps[made] = stamp_of(config)
        return made

    def after(self, before: Pipeline, config: PipelineConfig) -> Pipeline | None:
        """A pipeline after another one; None if files of its scene are not those that were read for that one."""
        if (stamp := stamp_of(config)) != self._stamps.get(before):
            return None
        made = Pipeline.from_config(config, like=before)
        self._stamps[made] = stamp
        return made

    @contextmanager
    def work(self, pipeline: Pipeline, number: int) -> Generator[Work]:
        """A long job's block; others see what it is at. Raises: Stopped if a newer one was asked for already."""
        work = Work(pipeline)
        with self._lock:
            if number < self._newest:
                raise Stopped
            self._work = work
        try:
            yield work
            work.worth = True
        finally:
            with self._lock:
                self._work = None
            if work.worth:
                self.pipeline = pipeline

    def give_way(self, number: int, to: Pipeline, want: str) -> bool:
        """Jobs below this number stop, or do not begin; whether one was told to stop at once."""
        with self._lock:
            self._newest, work = number, self._work
        return work is not None and work.give_way(to, want)
