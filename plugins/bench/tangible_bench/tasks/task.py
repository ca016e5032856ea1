"""The `Task`: all that the bench must know about a kind of method; its other rooms know no kind."""

from abc import abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from importlib import import_module
from pathlib import Path
from typing import Any, Literal, TypeVar, cast

from tangible_core.data import Kind, Quantities, Record
from tangible_core.errors import PictureError, quoted

Apply = Callable[[Any, float], Any]


class SceneSpec(Quantities):
    """The options of a scene in a comparison file: plain values, which open the same scene in every process."""

    @classmethod
    @abstractmethod
    def parse_name(cls, name: str) -> Mapping[str, Any]:
        """Return the options that a plain name stands for. Raises: ValueError for an unknown name."""

    @abstractmethod
    def expand(self) -> "Mapping[str, SceneSpec]":
        """Return the scenes that this one stands for, by name: itself, or each sub-folder's. Raises: TangibleError."""

    @abstractmethod
    def open(self) -> Record:
        """Read the inputs and the truth. Raises: TangibleError for a scene that cannot be read."""


Spec = TypeVar("Spec", bound=SceneSpec)
Item = TypeVar("Item")


def check_one_kind(names: list[str], kinds: str) -> None:
    """Check the kinds of scene that are given. Raises: ValueError unless there is exactly one."""
    if len(names) != 1:
        raise ValueError(f"a scene is one of {kinds}; this one is {' and '.join(names) or 'none'}")


def expand_folder(spec: Spec, folder: Path, first: str, contents: str) -> dict[str, Spec]:
    """Return a scene for each sub-folder that has the file `first`. Raises: PictureError if none has."""
    folders = sorted(path.parent for path in folder.glob(f"*/{first}"))
    if not folders:
        raise PictureError(f"{folder}: neither it nor a folder in it holds {contents}")
    return {sub_folder.name: spec.model_copy(update={"folder": sub_folder}) for sub_folder in folders}


def with_folder_of_file(block: Any) -> Any:
    """Return the options of a scene; patterns (`pairs`) without a folder get that of the comparison file."""
    has_pairs = isinstance(block, dict) and "pairs" in block
    return {"folder": Path(), **cast("dict[str, Any]", block)} if has_pairs else cast(Any, block)


def pick_pairs(all_pairs: dict[str, Item], only: tuple[str | int, ...], folder: Path) -> dict[str, Item]:
    """Return the named pairs, in the order of `only`; all pairs if that is empty. Raises: PictureError."""
    if missing := next((name for name in only if str(name) not in all_pairs), None):
        raise PictureError(f"{folder}: no pair in it is named {quoted(missing)}; there are {', '.join(all_pairs)}")
    return {str(name): all_pairs[str(name)] for name in only} if only else all_pairs


@dataclass(frozen=True)
class Measure:
    """A figure that is measured of each result."""

    title: str  # the column heading, with the unit
    digits: int = 2
    best: Literal["low", "high"] = "low"
    tolerance: float = 0.005  # the largest difference between two files that counts as the same
    # True if the measure counts pixels: its heading then names their size, unless that is the full one.
    at_size: bool = False
    # True if only scenes of standard sets have the measure; tables of other scenes leave it out.
    of_sets: bool = False


@dataclass(frozen=True)
class Clock:
    """The unit of times."""

    unit: str = "ms"
    per_second: float = 1e3
    # (scene) -> number of pieces of work in a call; times are those of one piece.
    pieces: Callable[[Any], int] = lambda scene: 1


@dataclass(frozen=True)
class Perturbation:
    """A controlled damage to a scene, the same for every method."""

    meaning: str
    is_valid: Callable[[float], bool]
    apply: Apply


@dataclass(frozen=True)
class Curve:
    """A curve that is drawn of each method, next to its ideal one."""

    title: str  # the label of the vertical axis, with the unit
    over: str  # the label of the horizontal axis, with the unit
    # Horizontal position -> name of a value of `Task.measure`; no table shows these values.
    points: Mapping[int, str]
    ideal: Mapping[int, str]  # horizontal position -> name of the value for the ideal curve


@dataclass(frozen=True)
class Task:
    """A kind of method that can be compared."""

    kind: Kind
    version: int
    """The version of the measures; raise it when one changes its meaning: rows of other versions are measured again."""
    scene: type[SceneSpec]
    work: Callable[[Any, Any], Any]
    """The timed call: (result of `prepare`, scene) -> result."""
    measure: Callable[[Any, Any], Mapping[str, float]]
    """(result, scene) -> a value for each of `measures` and each point of `curve`, NaN if unknown.
    Raises: TangibleError."""
    measures: Mapping[str, Measure]
    columns: tuple[str, ...]
    """The measures that the table shows; the first one ranks the methods."""
    plot_measures: tuple[str, ...]
    """The measures that are drawn over time, one panel each."""
    curve: Curve | None = None
    prepare: Callable[[Any, Any], Any] = lambda method, scene: method
    """(method, scene) -> argument of `work`; called before each call. Untimed, but it counts for memory and for the
    very first call."""
    clock: Clock = Clock()
    perturbations: Mapping[str, Perturbation] = field(default_factory=dict[str, Perturbation])
    facts: Mapping[str, Callable[[Any], Any]] = field(default_factory=dict[str, Callable[[Any], Any]])
    """Options of methods whose values follow from a scene: name -> (scene) -> value."""
    finishes: Mapping[str, Callable[[Any], Any]] = field(default_factory=dict[str, Callable[[Any], Any]])
    """Untimed steps that a comparison may apply to the results of chosen methods, by their keys in its file."""
    doubt: Callable[[Any, Any], str] = lambda method, scene: ""
    """(method, scene) -> why the method's options keep it from the truth of the scene; empty if they do not."""
    scene_size: Callable[[str], str] = lambda scene: ""
    """(name of a scene) -> its size, such as Q; empty for the full size."""


TASKS = {"depth": "depth", "texture": "texture", "render": "render"}
"""Kinds that can be compared -> the module of this room that has their `TASK`."""


def load_task(kind: str) -> Task:
    """Return the task of a kind in TASKS, imported on first use."""
    return import_module(f"{__package__}.{TASKS[kind]}").TASK
