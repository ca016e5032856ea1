"""The installed procedures: ours, and those of other packages by the group of entry points `tangible.procedure`."""

from collections.abc import Mapping
from importlib.metadata import EntryPoint, entry_points
from typing import Any, cast

from tangible_core.errors import BrokenMethod, UnknownName, shown

from .procedure import Procedure

GROUP = "tangible.procedure"
OURS = {
    "constant": "constant:Constant",
    "2afc": "two_afc:TwoAfc",
    "oddity": "oddity:Oddity",
    "quest": "quest:Quest",
    "adjustment": "adjustment:Adjustment",
    "naming": "naming:Naming",
    "rating": "rating:Rating",
}
"""Our own procedures, which no other package can replace."""
DEFAULTS: Mapping[str, str] = {
    "rougher": "2afc",
    "higher": "2afc",
    "same": "oddity",
    "equal": "adjustment",
    "name": "naming",
    "rating": "rating",
}
"""Procedure of each question, if the file names none."""


def procedure_names() -> list[str]:
    """Return the names of all installed procedures, ours first. Nothing is imported."""
    return list(_points())


def load_procedure(name: str) -> type[Procedure]:
    """Import the class of a procedure; its fields are its options. Raises: UnknownName, BrokenMethod."""
    points = _points()
    if name not in points:
        raise UnknownName("procedure", name, points)
    try:
        procedure = cast(Any, points[name].load())
    except (Exception, SystemExit) as error:
        raise BrokenMethod(
            f"procedure {name!r} ({points[name].value}) cannot be loaded: {type(error).__name__}: "
            f"{shown(str(error), 500)}; repair or remove its package"
        ) from error
    if not (isinstance(procedure, type) and issubclass(procedure, Procedure)):
        raise BrokenMethod(f"procedure {name!r} ({points[name].value}) is not a Procedure")
    return procedure


def _points() -> dict[str, EntryPoint]:
    others = {each.name: each for each in entry_points(group=GROUP)}
    ours = {name: EntryPoint(name, f"{__package__}.{place}", GROUP) for name, place in OURS.items()}
    return {**ours, **{name: point for name, point in others.items() if name not in ours}}
