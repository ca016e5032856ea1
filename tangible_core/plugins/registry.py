"""The registry of installed methods: names from metadata, classes on first use."""

from __future__ import annotations

import ast
import logging
import re
from dataclasses import dataclass
from functools import cache, cached_property
from importlib.metadata import EntryPoint, entry_points
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, cast, overload

from ..errors import BrokenMethod, UnknownMethod, UnknownName, did_you_mean, shown
from ..runtime.failure_log import where_kept
from ..runtime.stopping import warn_if_slow
from . import hooks
from .naming import KIND_NAMES as KIND_NAMES
from .naming import origin

if TYPE_CHECKING:
    import pluggy

    from ..data import Kind
    from .interfaces import DepthEstimator, Exporter, ForceRenderer, HapticDevice, Method, Segmenter


log: logging.Logger = logging.getLogger(__name__)


@dataclass(frozen=True)
class Listing:
    """An installed method, as far as it is known without importing it."""

    kind: str
    name: str
    target: str
    origin: str
    """The distribution and its version."""
    point: EntryPoint

    @property
    def distribution(self) -> str:
        """The distribution's name, to tell two methods of one name apart."""
        return self.origin.split(" ")[0]

    @cached_property
    def summary(self) -> str:
        """The first line of the class's docstring, read from the source text."""
        try:
            return _docstring_line(self.point)
        except (OSError, SyntaxError, ImportError, ValueError) as error:
            return f"(cannot be read: {error})"


class Registry:
    """The registry of installed plugins: listing reads metadata only, `load` alone imports a plugin."""

    def __init__(self, plugins: pluggy.PluginManager | None = None) -> None:
        self.plugins: pluggy.PluginManager = hooks.manager() if plugins is None else plugins

    @cached_property
    def listings(self) -> tuple[Listing, ...]:
        """The installed methods, two of one name included, by kind and name."""
        all_points = entry_points()  # one walk over all distributions serves all kinds
        listings = [
            Listing(kind, point.name, point.value, str(origin(point.dist)), point)
            for kind in KIND_NAMES
            for point in (*all_points.select(group=f"tangible.{kind}"), *self._points_of_hooks(kind))
        ]
        return tuple(sorted(listings, key=lambda each: (KIND_NAMES.index(each.kind), each.name, each.origin)))

    def names(self, kind: str) -> list[str]:
        """Return the names to write after `use:`: `distribution/name` where two distributions offer the same name."""
        of_kind = [listing for listing in self.listings if listing.kind == kind]
        short = [each.name for each in of_kind]
        return [each.name if short.count(each.name) == 1 else f"{each.distribution}/{each.name}" for each in of_kind]

    def find(self, kind: str, name: str) -> Listing:
        """Find the listing of this name."""
        if kind not in KIND_NAMES:
            raise UnknownName("kind of methods", kind, KIND_NAMES)
        distribution, _, short = str(name).rpartition("/")
        listings = [
            listing
            for listing in self.listings
            if listing.kind == kind and listing.name == short and distribution in ("", listing.distribution)
        ]
        if not listings:
            raise UnknownMethod(kind, name, self.names(kind), self._meant(kind, short))
        if len(listings) > 1:
            raise BrokenMethod(
                f"{kind} method {name!r} is offered by {' and '.join(listing.origin for listing in listings)}; "
                f"write {' or '.join(f'{listing.distribution}/{short}' for listing in listings)}"
            )
        return listings[0]

    def _meant(self, kind: str, word: str) -> str:
        """Return the method whose initials a word begins with (sgm), or whose summary has it (god-object, pdf)."""
        of_kind = [each for each in self.listings if each.kind == kind and len(word) > 2]
        for each in of_kind:
            initials = "".join(part[0] for part in each.name.split("-"))
            if len(initials) > 1 and word.startswith(initials) and len(word) <= len(initials) + 1:
                return each.name
        pattern = re.compile(rf"\b{re.escape(word)}\b", re.IGNORECASE)
        return next((each.name for each in of_kind if pattern.search(each.summary)), "")

    def load(self, kind: str, name: str) -> type[Method]:
        """Import the class of a method."""
        from .interfaces import KINDS

        listing = self.find(kind, name)
        try:
            with warn_if_slow(log, f"importing {kind} method {name} ({listing.target}, from {listing.origin})"):
                cls: Any = listing.point.load()
        except (Exception, SystemExit) as error:
            from .failures import lacks_memory

            if lacks_memory(error):
                raise
            raise BrokenMethod(
                f"{kind} method {name!r} ({listing.target}, from {listing.origin}) cannot be loaded: "
                f"{type(error).__name__}: {shown(str(error), 500)}; repair or remove {listing.distribution}; "
                f"{where_kept(error)}"
            ) from error
        interface = KINDS[listing.kind]  # pyright: ignore[reportArgumentType]
        if not (isinstance(cls, type) and issubclass(cls, interface)):
            raise BrokenMethod(
                f"{kind} method {name!r} ({listing.target}, from {listing.origin}) is not a {interface.__name__}"
            )
        if missing := sorted(cls.__abstractmethods__):
            raise BrokenMethod(f"{kind} method {name!r} ({listing.target}) does not implement {', '.join(missing)}")
        return cls

    def _points_of_hooks(self, kind: str) -> list[EntryPoint]:
        answers: list[Any] = hooks.tell(self.plugins, "tangible_methods", kind=kind)
        pairs = [pair for more in answers if isinstance(more, dict) for pair in cast("dict[Any, Any]", more).items()]
        return [EntryPoint(str(name), str(value), f"tangible.{kind}") for name, value in pairs]


@cache
def default_registry() -> Registry:
    """Return the registry of this installation."""
    return Registry()


@overload
def load_method(kind: Literal["depth"], name: str) -> type[DepthEstimator]: ...
@overload
def load_method(kind: Literal["texture"], name: str) -> type[Segmenter]: ...
@overload
def load_method(kind: Literal["render"], name: str) -> type[ForceRenderer]: ...
@overload
def load_method(kind: Literal["device"], name: str) -> type[HapticDevice]: ...
@overload
def load_method(kind: Literal["export"], name: str) -> type[Exporter]: ...
@overload
def load_method(kind: Kind, name: str) -> type[Method]: ...
def load_method(kind: str, name: str) -> type[Any]:
    """Import the class of an installed method; its fields are its options. Raises: UnknownMethod, BrokenMethod."""
    return default_registry().load(kind, name)


def _docstring_line(point: EntryPoint) -> str:
    """Read the first line of the class's docstring without running the module: its top package is located only."""
    target = EntryPoint.pattern.match(point.value)
    if target is None or not target["attr"]:
        raise ImportError(f"{point.value!r} is not package.module:Class")
    text = _source(*target["module"].split(".")).read_text(encoding="utf-8")
    if plain := re.search(_PLAIN_CLASS.format(re.escape(target["attr"])), text, re.MULTILINE):
        return plain[1]
    tree = ast.parse(text)
    classes = {node.name: node for node in tree.body if isinstance(node, ast.ClassDef)}
    if target["attr"] not in classes:
        raise ImportError(f"{target['module']} has no class {target['attr']}{did_you_mean(target['attr'], classes)}")
    return (ast.get_docstring(classes[target["attr"]]) or "(no docstring)").splitlines()[0]


_PLAIN_CLASS = r"^class {}\b[^\n]*:\n    \"\"\"(\w[^\n\\]*?)(?:\"\"\")?$"
"""A class in the usual layout with the first line of its docstring; Python's parser takes a fifth of the listing's
time."""


def _source(top: str, *rest: str) -> Path:
    spec = find_spec(top)
    if spec is None:
        raise ImportError(f"there is no module {top}")
    if not spec.submodule_search_locations:
        return Path(spec.origin or "").joinpath(*rest)  # a path below a file, which cannot be read
    module = Path(next(iter(spec.submodule_search_locations))).joinpath(*rest)
    return module / "__init__.py" if module.is_dir() else module.with_suffix(".py")
