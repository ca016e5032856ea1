"""The methods of a comparison file: names, options, and grids of options."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from itertools import product
from typing import Any, cast

from pydantic import ValidationError

from tangible_core.errors import ConfigError, did_you_mean, quoted
from tangible_core.files.yaml import Location, Source
from tangible_core.pipeline.config import NamedMethod, choose
from tangible_core.plugins import Method
from tangible_core.plugins.registry import Registry

from ..tasks.task import Task


@dataclass(frozen=True)
class Entry:
    """A method with its options, and its label in tables."""

    label: str
    choice: NamedMethod[Method]
    fact_names: tuple[str, ...] = ()  # options that are set for each scene, from known facts of the scene

    def method_for(self, facts: Mapping[str, Any]) -> Method:
        """Return the method with the options that the facts of a scene give. Raises: ConfigError for a bad value."""
        method = self.choice.method
        options = {name: facts[name] for name in self.fact_names}
        try:
            return type(method).model_validate({**method.model_dump(), **options}) if options else method
        except ValidationError as error:
            why = error.errors()[0]["msg"].removeprefix("Value error, ")
            raise ConfigError(f"{self.label} cannot be given {options}: {why}; leave out its `given:`") from error


def read_methods(source: Source, task: Task, registry: Registry) -> tuple[Entry, ...]:
    """Read the file's `methods:`; mistakes are collected in the source."""
    entries: dict[str, Entry] = {}
    for index, block in enumerate(source.items("methods")):
        for entry in _entries(source, ("methods", index), block, task, registry):
            if entry.label in entries:
                source.complain(("methods", index), f"two methods are called {entry.label!r}; give one a `label:`")
            entries[entry.label] = entry
    return tuple(entries.values())


def _entries(source: Source, place: Location, block: Any, task: Task, registry: Registry) -> Iterable[Entry]:
    """Yield one method, or one for each point of the grid that `sweep:` spans."""
    options: dict[str, Any] = dict(cast("dict[str, Any]", block)) if isinstance(block, dict) else {"use": block}
    label, fact_names, sweep = options.pop("label", None), options.pop("given", []), options.pop("sweep", None)
    if label is not None and not isinstance(label, str):
        source.complain((*place, "label"), f"a label is a word, not {quoted(label)}")
    grid = {} if sweep is None else _grid(source, (*place, "sweep"), sweep)
    if grid and choose(source, place, task.kind, {"use": options.get("use")}, registry) is None:
        return
    where = (*place, "sweep") if grid else place
    for point in product(*([(name, value) for value in values] for name, values in grid.items())):
        choice = choose(source, where, task.kind, {**options, **dict(point)}, registry)
        if choice is None or not _can_be_given(source, (*place, "given"), fact_names, task, choice.method):
            return  # the same mistake at every point of the grid is one complaint
        name = " ".join((str(label or choice.name), *(f"{name}={value}" for name, value in point)))
        yield Entry(name, choice, tuple(fact_names))


def _grid(source: Source, place: Location, block: Any) -> dict[str, list[Any]]:
    grid = cast("dict[str, list[Any]]", block) if isinstance(block, dict) else {}
    if grid and all(isinstance(values, list) and values for values in grid.values()):  # pyright: ignore[reportUnnecessaryIsInstance]
        return grid
    source.complain(place, "`sweep:` maps an option to the list of values to try, such as {window_px: [3, 5]}")
    return {}


def _can_be_given(source: Source, place: Location, fact_names: Any, task: Task, method: Method) -> bool:
    names = cast("list[Any]", fact_names) if isinstance(fact_names, list) else [fact_names]
    options = sorted(set(task.facts) & set(type(method).model_fields))  # a list, as a name in the file may be any value
    for name in names:
        if name not in options:
            hint = did_you_mean(str(name), options)
            source.complain(
                place,
                f"given: no scene gives {quoted(name)} to this method{hint}; known: "
                + (", ".join(options) or "nothing"),
            )
    return isinstance(fact_names, list) and all(name in options for name in names)
