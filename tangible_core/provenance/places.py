"""The location of a module's source, and the choice between its text and its distribution's version."""

import sys
from functools import cache
from importlib import util
from importlib.machinery import ModuleSpec, PathFinder
from pathlib import Path
from typing import NamedTuple

from . import versions

INSTALLED = {"site-packages", "dist-packages"}
"""The folders of installed packages, whose source does not change between versions."""

HOME = __name__.partition(".")[0]


class Place(NamedTuple):
    """A module, its file, and the package where its relative imports start."""

    name: str
    file: str
    package: str

    @property
    def is_package(self) -> bool:
        """True for a package."""
        return self.name == self.package

    @property
    def top(self) -> str:
        """The top package of the module, or the module itself."""
        return (self.package or self.name).partition(".")[0]


@cache
def place(name: str) -> Place | None:
    """Return the module of this name, as it was or would be imported; None if it is not a module."""
    module = sys.modules.get(name)
    file, package = (getattr(module, each, None) for each in ("__file__", "__package__"))
    if isinstance(file, str):
        return Place(name, file, package or "")
    spec = _spec(name)
    if spec is None or not spec.has_location or spec.origin is None:
        return None
    return Place(name, spec.origin, spec.parent or "")


@cache
def is_read(top: str) -> bool:
    """Return True if the source of a top package is read: that of Tangible Images, and code that may be edited."""
    if top in sys.stdlib_module_names or top in versions.LIBRARIES:
        return False
    if top == HOME:
        return True
    spec = _spec(top)
    where = [] if spec is None else [*(spec.submodule_search_locations or ()), spec.origin or ""]
    return not any(INSTALLED & set(Path(each).parts) for each in where) or versions.is_plugin(top)


@cache
def _spec(name: str) -> ModuleSpec | None:
    """Find how a module would be imported; unlike `find_spec`, without importing the packages above it."""
    above = name.rpartition(".")[0]
    if not above:
        try:
            return util.find_spec(name)
        except ValueError:  # a module without a spec, such as `__main__`
            return None
    parent = _spec(above)
    if parent is None or parent.submodule_search_locations is None:
        return None
    return PathFinder.find_spec(name, list(parent.submodule_search_locations))
