"""How fast and how exact each method was when all of them were measured: figures that come with the program.

`python -m benchmarks methods` writes them; nobody else does.
"""

from collections.abc import Mapping
from functools import cache
from importlib.resources import files
from typing import Annotated

from pydantic import Field, TypeAdapter
from pydantic.dataclasses import dataclass

FILE = "measured.json"


@dataclass(frozen=True)
class Measured:
    """The methods of one kind, with their defaults, side by side on the same scene."""

    scene: str
    day: str
    machine: Mapping[str, str | int]
    versions: Mapping[str, str]
    columns: tuple[str, ...]
    """What the figures are, with units: time, memory, and the measures of the kind, the one that counts first."""
    methods: Mapping[str, tuple[float | None, ...]]
    """Name -> a value for each column, None where there is none."""
    process_s: Mapping[str, float]
    """Name -> how long its process took for a warm-up and three calls, start, scene and measures included."""
    failed: Annotated[Mapping[str, str], Field(default_factory=dict)]
    """Name -> why there is no figure at all."""


Kinds = TypeAdapter(dict[str, Measured])


@cache
def measured() -> Mapping[str, Measured]:
    """By kind."""
    return Kinds.validate_json(files("tangible_core.metrics").joinpath(FILE).read_bytes())


def in_words(machine: Mapping[str, str | int]) -> str:
    """A machine as a sentence names it.

    >>> in_words({"processor": "Acme 9000", "cores": 2, "system": "Linux x86_64"})
    'Acme 9000, 2 cores, Linux x86_64'
    """
    return f"{machine['processor']}, {machine['cores']} cores, {machine['system']}"
