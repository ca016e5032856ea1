"""The measured times and errors of all methods, which come with the program."""

from collections.abc import Mapping
from functools import cache
from importlib.resources import files
from typing import Annotated

from pydantic import Field, TypeAdapter
from pydantic.dataclasses import dataclass

FILE = "measured.json"


@dataclass(frozen=True)
class Measured:
    """The figures of the methods of one kind, with their defaults, on the same scene."""

    scene: str
    day: str
    machine: Mapping[str, str | int]
    versions: Mapping[str, str]
    # The names of the figures, with units: time, memory, and the measures of the kind, the most important first.
    columns: tuple[str, ...]
    # The figures of each method by its name, in the order of the columns; None for a missing one.
    methods: Mapping[str, tuple[float | None, ...]]
    # The time of each method's process for a warm-up and three calls, with start, scene and measures, by its name.
    process_s: Mapping[str, float]
    # The reason why a method has no figures, by its name.
    failed: Annotated[Mapping[str, str], Field(default_factory=dict)]


Kinds: TypeAdapter[dict[str, Measured]] = TypeAdapter(dict[str, Measured])


@cache
def load_measured() -> Mapping[str, Measured]:
    """Read the figures, by kind."""
    return Kinds.validate_json(files("tangible_core.metrics").joinpath(FILE).read_bytes())


def in_words(machine: Mapping[str, str | int]) -> str:
    """Name a machine in a sentence.

    >>> in_words({"processor": "Acme 9000", "cores": 2, "system": "Linux x86_64"})
    'Acme 9000, 2 cores, Linux x86_64'
    """
    return f"{machine['processor']}, {machine['cores']} cores, {machine['system']}"
