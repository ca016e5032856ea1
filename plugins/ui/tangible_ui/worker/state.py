"""The worker's state, and the progress of a long job."""

from collections.abc import Callable, Generator
from contextlib import contextmanager, suppress
from pathlib import Path
from threading import Event, Lock
from typing import Any, final
from weakref import WeakKeyDictionary

from tangible_core.errors import Stopped
from tangible_core.pipeline import Pipeline
from tangible_core.pipeline.config import PipelineConfig, parse_config
from tangible_core.pipeline.engine import Cache, StageEvent
from tangible_core.plugins.registry import Registry, default_registry
from tangible_core.scene import SceneFiles

NEVER = -1


Stamp = tuple[tuple[Path, int, int], ...]  # files with the time of their last change, and their size


def scene_stamp(config: PipelineConfig) -> Stamp:
    """Return the stamp of a scene's existing files; empty for a built-in scene."""
    fields = config.scene if isinstance(config.scene, SceneFiles) else ()
    paths = [config.folder / value for _, value in fields if isinstance(value, Path)]
    stamp: list[tuple[Path, int, int]] = []
    for path in paths:
        with suppress(OSError, ValueError):
            status = path.stat()
            stamp.append((path, status.st_mtime_ns, status.st_size))
    return tuple(stamp)


# A function that sends an event to all pages: its name, and its fields by name.
Tell = Callable[..., None]


@final
class Work:
    """The progress of a long job: one stage after the other, until a stop."""

    def __init__(self, pipeline: Pipeline) -> None:
        self.pipeline = pipeline
        self.stop: Event = Event()
        self.worth = False
        """True if there is something to show, even if the rest fails."""
        self._product = ""
        self._after = False

    def follow(self, stage: StageEvent) -> None:
        """Note the begin or end of a stage."""
        self._product = "" if stage.outcome else stage.product
        if stage.outcome and self._after:
            self.stop.set()

    def give_way(self, to: Pipeline, want: str) -> bool:
        """Stop for another pipeline: at once, or after a stage that it needs too. Returns: True if at once."""
        product, inputs = self._product, to.engine.all_inputs(want)
        if product in inputs and self.pipeline.engine.key(product) == to.engine.key(product):
            self._after = True
            return False
        self.stop.set()
        return True


@final
class WorkerState:
    """The last pipeline that was felt or shown, and the folder for pages."""

    def __init__(self, folder: Path, tell: Tell, cache: Cache | None = None) -> None:
        """cache: of results; the user's own by default."""
        self.folder = folder
        self.tell = tell
        self.registry: Registry = default_registry()
        self.pipeline: Pipeline | None = None
        self.shown_digest = ""
        """Digest of the surface that pages got last."""
        self.description: Any = None
        """The pipeline and the view whose description pages got last."""
        self.editor: Any = None
        """The scene in the parts editor; used by quick jobs alone."""
        self.tree: Any = None
        """The picture in the parts editor, and its tree of regions; used by quick jobs alone."""
        self.preview: Any = None
        """The heights of parts that are tried; used by quick jobs alone."""
        self._cache = cache or Cache()
        self._stamps: WeakKeyDictionary[Pipeline, Stamp] = WeakKeyDictionary()
        self._newest, self._work = NEVER, None
        self._last_config: tuple[Any, PipelineConfig] | None = None
        self._lock = Lock()

    def read_config(self, text: str, path: Path, sets: list[str]) -> PipelineConfig:
        """Return the configuration of a text; the last one is cached for further jobs. Raises: ConfigError."""
        key = text, path, tuple(sets)
        if (last := self._last_config) is not None and last[0] == key:
            return last[1]
        config = parse_config(text, path, self.registry, sets)
        self._last_config = key, config
        return config

    def make_pipeline(self, text: str, path: Path, sets: list[str], language: str = "") -> Pipeline:
        """Return the pipeline of a text, in `language` if it names none; it shares results. Raises: ConfigError."""
        config, before = self.read_config(text, path, sets), self.pipeline
        if language and "language" not in config.model_fields_set:
            config = config.with_values(language=language)
        pipeline = self.after(before, config) if before is not None else None
        if pipeline is None:
            pipeline = Pipeline.from_config(config, self.registry, self._cache)
            self._stamps[pipeline] = scene_stamp(config)
        return pipeline

    def after(self, before: Pipeline, config: PipelineConfig) -> Pipeline | None:
        """Return a pipeline derived from another; None if files of its scene have changed since."""
        if (stamp := scene_stamp(config)) != self._stamps.get(before):
            return None
        pipeline = Pipeline.from_config(config, like=before)
        self._stamps[pipeline] = stamp
        return pipeline

    @contextmanager
    def work(self, pipeline: Pipeline, number: int) -> Generator[Work]:
        """Yield the progress of a long job. Raises: Stopped if a newer job was requested already."""
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
        """Stop jobs below this number, and keep them from starting. Returns: True if a running one stops at once."""
        with self._lock:
            self._newest, work = number, self._work
        return work is not None and work.give_way(to, want)
