"""The installed procedures: ours, and those of other packages by the group of entry points `tangible.procedure`."""

from typing import Any, cast

from tangible_core.errors import BrokenMethod, UnknownName, shown

from ..points import points
from .procedure import Procedure


def procedure_names() -> list[str]:
    """Return the names of all installed procedures, ours first. Nothing is imported."""
    return list(points())


def load_procedure(name: str) -> type[Procedure]:
    """Import the class of a procedure; its fields are its options. Raises: UnknownName, BrokenMethod."""
    there = points()
    if name not in there:
        raise UnknownName("procedure", name, there)
    try:
        procedure = cast(Any, there[name].load())
    except (Exception, SystemExit) as error:
        raise BrokenMethod(
            f"procedure {name!r} ({there[name].value}) cannot be loaded: {type(error).__name__}: "
            f"{shown(str(error), 500)}; repair or remove its package"
        ) from error
    if not (isinstance(procedure, type) and issubclass(procedure, Procedure)):
        raise BrokenMethod(f"procedure {name!r} ({there[name].value}) is not a Procedure")
    return procedure
