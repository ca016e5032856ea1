"""What it takes to compare methods of one kind: scenes, perturbations, the call to time, the measures of its result.

Everything else in this room knows no kind: it plans, runs, keeps, sums up and draws what a `Task` measures.
"""

from abc import abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from importlib import import_module
from typing import Any, Literal

from pydantic import ConfigDict

from tangible_core.data import Kind, Record
from tangible_core.data.quantities import Quantities

Apply = Callable[[Any, float], Any]


class SceneSpec(Quantities):
    """Which scene, as the file says it: a few plain options, the same in every process."""

    model_config = ConfigDict(frozen=True, extra="forbid", use_attribute_docstrings=True)

    @classmethod
    @abstractmethod
    def named(cls, name: str) -> Mapping[str, Any]:
        """The options that a plain name stands for. Raises: ValueError for a name that stands for none."""

    @abstractmethod
    def expand(self) -> "Mapping[str, SceneSpec]":
        """The scenes that this one stands for, by name: itself, or each sub-folder's. Raises: TangibleError."""

    @abstractmethod
    def open(self) -> Record:
        """Inputs and truth. Raises: TangibleError for a scene that cannot be read."""


@dataclass(frozen=True)
class Measure:
    """A figure of a result."""

    title: str
    """Column heading, with the unit."""
    digits: int = 2
    best: Literal["low", "high"] = "low"
    tolerance: float = 0.005
    """The most by which it may get worse between two files and count as the same."""
    at_size: bool = False
    """Whether it counts pixels, so that a heading says of which size they are where that is not the full one."""
    of_sets: bool = False
    """Whether scenes of standard sets alone have it: a table of others leaves it out."""


@dataclass(frozen=True)
class Clock:
    """How times are told."""

    unit: str = "ms"
    """Column heading."""
    per_second: float = 1e3
    pieces: Callable[[Any], int] = lambda scene: 1
    """(scene) -> how many pieces of work a call does on it: its time is that of one."""


@dataclass(frozen=True)
class Perturbation:
    """A controlled damage to a scene, the same for every method."""

    meaning: str
    """What its values are, with the unit and the range."""
    allowed: Callable[[float], bool]
    apply: Apply


@dataclass(frozen=True)
class Curve:
    """A measure that is drawn over something else than time, of each method and of the best there could be."""

    title: str
    """Of the upright axis, with the unit."""
    over: str
    """What the level axis tells, with the unit."""
    points: Mapping[int, str]
    """Names of what `Task.measure` gives at each place; no column of a table shows them."""
    ideal: Mapping[int, str]
    """The same of what the method would have if it were perfect in this."""


@dataclass(frozen=True)
class Task:
    """Everything that a comparison must know about one kind of method."""

    kind: Kind
    version: int
    """Raise it when a measure changes its meaning: rows of another version are measured again."""
    scene: type[SceneSpec]
    work: Callable[[Any, Any], Any]
    """(what `prepare` gives, scene) -> result: what is timed."""
    measure: Callable[[Any, Any], Mapping[str, float]]
    """(result, scene) -> a value for each of `measures` and each point of `curve`, NaN where there is none.
    Raises: TangibleError."""
    measures: Mapping[str, Measure]
    columns: tuple[str, ...]
    """Measures that the table shows, the first one being what methods are judged by."""
    plotted: tuple[str, ...]
    """Measures drawn against time, one panel each."""
    curve: Curve | None = None
    """Drawn in a panel of its own."""
    prepare: Callable[[Any, Any], Any] = lambda method, scene: method
    """(method, scene) -> what `work` takes, the method itself if not said; made anew for each call. Untimed, but it
    counts for memory and for the very first call."""
    clock: Clock = Clock()
    perturbations: Mapping[str, Perturbation] = field(default_factory=dict[str, Perturbation])
    given: Mapping[str, Callable[[Any], Any]] = field(default_factory=dict[str, Callable[[Any], Any]])
    """Options that a method may be told from what is known of a scene: name -> (scene) -> value."""
    finishes: Mapping[str, Callable[[Any], Any]] = field(default_factory=dict[str, Callable[[Any], Any]])
    """Steps that a comparison may add to the results of chosen methods, untimed, under these keys of its file."""
    size_of: Callable[[str], str] = lambda scene: ""
    """(name of a scene) -> such as Q, where its pixels are not those of the full size; empty where they are."""


TASKS = {"depth": "depth", "texture": "texture", "render": "render"}
"""Kinds that can be compared, and the module of this room whose `TASK` says how."""


def load_task(kind: str) -> Task:
    """The task of a kind in TASKS, imported on first use."""
    return import_module(f"{__package__}.{TASKS[kind]}").TASK
