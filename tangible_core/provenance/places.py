"""Where the source of a module lies, and whether it is read or counts by the version of its distribution."""

import sys
from functools import cache
from importlib import util
from importlib.machinery import ModuleSpec, PathFinder
from pathlib import Path
from typing import NamedTuple

from . import versions

INSTALLED = {"site-packages", "dist-packages"}
"""Folders in whose packages nobody works."""

HOME = __name__.partition(".")[0]


class Place(NamedTuple):
    """A module, its file, and the package that its relative imports start from."""

    name: str
    file: str
    package: str

    @property
    def is_package(self) -> bool:
        """Whether there are modules below it."""
        return self.name == self.package

    @property
    def top(self) -> str:
        """The package that it is part of, or itself."""
        return (self.package or self.name).partition(".")[0]


@cache
def place(name: str) -> Place | None:
    """The module of this name: as it was imported, or else as it would be; None for a name that is no module."""
    module = sys.modules.get(name)
    file, package = (getattr(module, each, None) for each in ("__file__", "__package__"))
    if isinstance(file, str):
        return Place(name, file, package or "")
    spec = _spec(name)
    if spec is None or not spec.has_location or spec.origin is None:
        return None
    return Place(name, spec.origin, spec.parent or "")


@cache
def followed(top: str) -> bool:
    """Whether the source of a top package is read: it belongs to Tangible Images, or may be under work."""
    if top in sys.stdlib_module_names or top in versions.LIBRARIES:
        return False
    if top == HOME:
        return True
    spec = _spec(top)
    where = [] if spec is None else [*(spec.submodule_search_locations or ()), spec.origin or ""]
    return not any(INSTALLED & set(Path(each).parts) for each in where) or versions.is_plugin(top)


@cache
def _spec(name: str) -> ModuleSpec | None:
    """How a module would be imported. Unlike `find_spec`, imports no package above it."""
    above = name.rpartition(".")[0]
    if not above:
        try:
            return util.find_spec(name)
        except ValueError:  # a module that does not say where it is from, such as `__main__`
            return None
    parent = _spec(above)
    if parent is None or parent.submodule_search_locations is None:
        return None
    return PathFinder.find_spec(name, list(parent.submodule_search_locations))
