"""The observer models by name, and their options from a command line."""

from collections.abc import Mapping, Sequence
from typing import Any

from tangible_core.errors import ConfigError, did_you_mean, quoted
from tangible_core.files.yaml import parse_override

from ..study_file import StudyFile
from .detection import Detection
from .hand import Hand
from .observer import Observer
from .psychometric import Psychometric

OBSERVERS: Mapping[str, type[Observer]] = {"psychometric": Psychometric, "detection": Detection, "hand": Hand}
"""Observer models by name."""


def observer_of(name: str, sets: Sequence[str], file: StudyFile) -> Observer:
    """Return an observer for a study. sets: its options, `key=value` each.

    Raises: ConfigError for an unknown observer or option, or a comparison that the observer cannot take part in.
    """
    if name not in OBSERVERS:
        known = ", ".join(OBSERVERS)
        raise ConfigError(
            f"--observer: no observer is called {quoted(name)}{did_you_mean(name, OBSERVERS)}; known: {known}"
        )
    options: dict[str, Any] = {".".join(keys): value for keys, value in map(parse_override, sets)}
    observer = OBSERVERS[name](**options)
    for comparison in file.study.comparisons:
        if refusal := observer.refusal(comparison):
            raise ConfigError(f"{comparison.name}: {refusal}")
    return observer
