"""Lazy import of a package's names on first use, so that listing and `--help` import nothing."""

from collections.abc import Callable, Iterable, Mapping
from importlib import import_module
from sys import modules
from typing import Any


def lazily(package: str, rooms: Mapping[str, Iterable[str]]) -> tuple[list[str], Callable[[str], Any]]:
    """Return `__all__` and `__getattr__` of a package whose names come from these modules in it.

    >>> lazily("tangible_core", {"errors": ["TangibleError"]})[1]("TangibleError").__name__
    'TangibleError'
    """
    homes = {name: room for room, names in rooms.items() for name in names}

    def __getattr__(name: str) -> Any:
        if name not in homes:
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        value = getattr(import_module(f".{homes[name]}", package), name)
        setattr(modules[package], name, value)
        return value

    return sorted(homes), __getattr__
