"""Old names of `Pipeline`, and how they are spelt now; they stay for one release."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

from ..plugins.interfaces import HapticDevice
from .config.model import PipelineConfig
from .feeling import Feeling
from .output.parts_text import part_heights, to_correct


def _on(verb: str) -> Callable[[Any], Any]:
    """Return a verb of `Feeling` that takes the device last, or by name, as that of `Pipeline` did."""

    def verb_of(pipeline: Any) -> Any:
        def call(*arguments: Any, device: HapticDevice | None = None, **options: Any) -> Any:
            *rest, last = arguments or (None,)
            if isinstance(last, HapticDevice):
                device, arguments = last, tuple(rest)
            return getattr(Feeling(pipeline, device), verb)(*arguments, **options)

        return call

    return verb_of


def _with_config(pipeline: Any) -> Callable[[PipelineConfig], Any]:
    """Return the old `changed`: `from_config`, like this pipeline."""
    return lambda config: pipeline.from_config(config, like=pipeline)


OLD_NAMES: Mapping[str, Callable[[Any], Any]] = {
    "changed": _with_config,
    "views": lambda pipeline: pipeline.scene.views,
    "parts": lambda pipeline: pipeline.make("parts"),
    "simplified": lambda pipeline: pipeline.make("simplified"),
    "part_heights": lambda pipeline: part_heights(pipeline.engine),
    "parts_to_correct": lambda pipeline: partial(to_correct, pipeline.engine),
    "cache": lambda pipeline: pipeline.engine.cache,
    "threads": lambda pipeline: pipeline.engine.threads,
    "reliefs": lambda pipeline: Feeling(pipeline).reliefs,
    "film": _on("film"),
    "replay": _on("replay"),
    "followed": _on("track"),
    "parts_felt": _on("parts_felt"),
    "legible": _on("legible"),
    "flight": _on("flight"),
}
"""The old names, each with its value for a pipeline."""
