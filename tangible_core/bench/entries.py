"""The methods of a comparison file: names, options, and grids of options."""

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import product
from typing import Any, cast

from ..config import Chosen, Source
from ..data import Kind
from ..interfaces import Method
from ..registry import Registry

Place = tuple[Any, ...]


@dataclass(frozen=True)
class Entry:
    """A method with its options, under the name that tables give it."""

    label: str
    chosen: Chosen[Method]


def read_methods(source: Source, kind: Kind, registry: Registry) -> tuple[Entry, ...]:
    """The file's `methods:`; what is wrong with them is noted in the source."""
    found: dict[str, Entry] = {}
    for index, block in enumerate(source.items("methods")):
        for entry in _entries(source, ("methods", index), block, kind, registry):
            if entry.label in found:
                source.complain(("methods", index), f"two methods are called {entry.label!r}; give one a `label:`")
            found[entry.label] = entry
    return tuple(found.values())


def _entries(source: Source, place: Place, block: Any, kind: Kind, registry: Registry) -> Iterable[Entry]:
    """One method, or one for each point of the grid that `sweep:` spans."""
    options: dict[str, Any] = dict(cast("dict[str, Any]", block)) if isinstance(block, dict) else {"use": block}
    label = options.pop("label", None)
    if label is not None and not isinstance(label, str):
        source.complain((*place, "label"), f"a label is a word, not {label!r}")
    label = str(label or options.get("use"))
    if "sweep" not in options:
        chosen = source.chosen(place, kind, options, registry)
        return [] if chosen is None else [Entry(label, chosen)]
    return _swept(source, place, label, options, kind, registry)


def _swept(
    source: Source, place: Place, label: str, options: dict[str, Any], kind: Kind, registry: Registry
) -> Iterable[Entry]:
    grid = _grid(source, (*place, "sweep"), options.pop("sweep"))
    if grid is None or source.chosen(place, kind, {"use": options.get("use")}, registry) is None:
        return
    for point in product(*([(name, value) for value in values] for name, values in grid.items())):
        chosen = source.chosen((*place, "sweep"), kind, {**options, **dict(point)}, registry)
        if chosen is None:
            return  # the same mistake at every point of the grid is one complaint
        yield Entry(" ".join((label, *(f"{name}={value}" for name, value in point))), chosen)


def _grid(source: Source, place: Place, block: Any) -> dict[str, list[Any]] | None:
    grid = cast("dict[str, list[Any]]", block) if isinstance(block, dict) else {}
    if grid and all(isinstance(values, list) and values for values in grid.values()):  # pyright: ignore[reportUnnecessaryIsInstance]
        return grid
    return source.complain(place, "`sweep:` maps an option to the list of values to try, such as {window_px: [3, 5]}")
