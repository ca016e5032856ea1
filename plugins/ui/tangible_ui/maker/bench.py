"""What lies on the maker's bench, and what a job is."""

from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple, Protocol

from tangible_core.pipeline.cache import Cache
from tangible_core.pipeline.config import parse_config
from tangible_core.pipeline.pipeline import Pipeline
from tangible_core.plugins.registry import Registry, default_registry


class Tell(Protocol):
    """Says an event to all pages."""

    def __call__(self, event: str, **told: Any) -> None: ...


class Bench:
    """The pipeline that was made last, and the folder of what pages fetch."""

    def __init__(self, folder: Path, tell: Tell) -> None:
        self.folder, self.tell = folder, tell
        self.registry: Registry = default_registry()
        self.pipeline: Pipeline | None = None
        self.shown = ""
        """Digest of the surface that pages were told of last."""

    def pipeline_of(self, text: str, path: Path, sets: list[str]) -> Pipeline:
        """The pipeline that a text says; what is alike in the one before is not made again. Raises: ConfigError."""
        config = parse_config(text, path, self.registry, sets)
        before = self.pipeline
        self.pipeline = Pipeline.of(config, self.registry, Cache()) if before is None else before.changed(config)
        return self.pipeline


class Job(NamedTuple):
    """One thing the maker does: called with the bench, and with what was asked by name."""

    do: Callable[..., Any]
    quick: bool = False
    """Done beside a long job, not after it; it must leave `Bench.pipeline` alone."""
