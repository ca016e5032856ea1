"""The import closure of code: its own source, that of all it imports, and the versions of the libraries below."""

import hashlib
import os
import sys
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cache
from importlib.util import resolve_name
from pathlib import Path
from types import FunctionType
from typing import NamedTuple

from . import BEGUN_NS, versions
from .imports import Import, bound, imports
from .places import HOME, Place, followed, place

_OF_THIS_PROCESS = f"{os.getpid()} {BEGUN_NS}"


@dataclass(frozen=True)
class Closure:
    """What some code depends on."""

    digest: str
    """SHA-256 of the sources and the versions, shortened."""
    modules: tuple[str, ...]
    """Whose source it is of."""
    versions: Mapping[str, str]
    """Of Python, and of what is imported and not read."""
    settled: bool
    """Whether all files are older than this process. Where one is not, what runs may be what it said before: the digest
    is then one that no other process has."""


def closure(*modules: str, alone: tuple[str, ...] = ()) -> Closure:
    """That of modules by name, and of the mere text of those in `alone`.

    The source of a package is read if it is the modules' own or `tangible_core`, has plugins, or lies outside of the
    folders where packages are installed; of any other the version counts. Imports are found in the text: nothing runs,
    those inside of functions count, and a module that is imported by a computed name does not. Files are read once a
    process.
    """
    return _closure(tuple(found for name in modules if (found := place(name))), alone)


def closure_of_function(function: FunctionType) -> Closure | None:
    """That of the module which a function is from; None for one that is in no file, as in a notebook."""
    file = function.__code__.co_filename
    name, package = (str(function.__globals__.get(each) or "") for each in ("__name__", "__package__"))
    return _closure((Place(name, file, package),), ()) if Path(file).is_file() else None


@cache
def _closure(start: tuple[Place, ...], alone: tuple[str, ...]) -> Closure:
    walk = _Walk({each.top for each in start})
    walk.through(start)
    texts = {each.name: _text(each) for each in (*walk.done, *walk.beside, *map(place, alone)) if each is not None}
    said = versions.of_imported(walk.libraries)
    settled = all(text.settled for text in texts.values())
    state = hashlib.sha256(repr((sorted(said.items()), "" if settled else _OF_THIS_PROCESS)).encode())
    for name in sorted(texts):
        state.update(f"\0{name}\0{len(texts[name].content)}\0".encode() + texts[name].content)
    return Closure(state.hexdigest()[:24], tuple(sorted(texts)), said, settled)


@dataclass
class _Walk:
    """From module to module, along the imports."""

    own: set[str]
    """Top packages that are read wherever they lie."""
    done: set[Place] = field(default_factory=set[Place])
    beside: set[Place] = field(default_factory=set[Place])
    """Packages that only hand on names: their text counts, and not what they import for others."""
    libraries: set[str] = field(default_factory=set[str])

    def through(self, start: Iterable[Place]) -> None:
        waiting = [each for here in start for each in (*self._above(here.name), here)]
        while waiting:
            here = waiting.pop()
            if here not in self.done:
                self.done.add(here)
                waiting += [found for each in _text(here).imports for found in self._reached(each, here)]

    def _reached(self, each: Import, here: Place) -> Iterator[Place]:
        """The modules that an import runs, down to the one that it names."""
        module = _absolute(each, here)
        top = module.partition(".")[0]
        if top not in self.own and not followed(top):
            self.libraries.add(top)
            return
        below = place(f"{module}.{each.name}") if each.name else None
        yield from self._above(f"{module}.{each.name}" if below else module)
        if below:
            yield below
        elif found := place(module):
            yield from self._handed_on(found, each.name)

    def _handed_on(self, found: Place, name: str) -> Iterator[Place]:
        """Where a module has a name from, if that is all; else the module itself."""
        homes = [each for each in _text(found).imports if each.bound == name]
        if name in ("", "*") or not homes or not _hands_on(found) or name in _made(found):
            yield found
            return
        self.beside.add(found)
        for home in homes:
            yield from self._reached(home, found)

    def _above(self, module: str) -> Iterator[Place]:
        """The packages that a module lies in, which are run before it."""
        while module := module.rpartition(".")[0]:
            package = place(module)
            if package and _hands_on(package):
                self.beside.add(package)
            elif package:
                yield package


def _hands_on(package: Place) -> bool:
    """Whether a package's own file only hands on names, so that its other imports do nothing to a module in it.

    So it is in Tangible Images, and so it is said by a package that imports each of its names when it is asked for.
    """
    return package.is_package and (package.top == HOME or "__getattr__" in _made(package))


def _absolute(each: Import, here: Place) -> str:
    if not each.level:
        return each.module
    try:
        return resolve_name("." * each.level + each.module, here.package)
    except ImportError:  # beyond the top package: it would not run either
        return here.package


class _Text(NamedTuple):
    content: bytes = b""
    imports: tuple[Import, ...] = ()
    settled: bool = False


@cache
def _made(package: Place) -> frozenset[str]:
    """The names that a package's file makes itself."""
    try:
        return bound(_text(package).content)
    except (SyntaxError, ValueError):  # it would not run either
        return frozenset()


@cache
def _text(here: Place) -> _Text:
    """What a module's file says, read once a process."""
    try:
        state, content = Path(here.file).stat(), Path(here.file).read_bytes()
    except OSError:  # in an archive, or gone: what runs is not known
        return _Text()
    changed_ns = max(state.st_mtime_ns, 0 if sys.platform == "win32" else state.st_ctime_ns)
    settled = changed_ns < BEGUN_NS
    if not here.file.endswith(".py"):
        return _Text(content, settled=settled)
    try:
        return _Text(content, tuple(imports(content)), settled)
    except (SyntaxError, ValueError):  # it would not run either
        return _Text(content, settled=settled)
