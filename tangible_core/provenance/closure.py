"""The import closure of code: its own source, that of all it imports, and the versions of the libraries below."""

import ast
import hashlib
import os
import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cache
from importlib.util import resolve_name
from pathlib import Path
from types import FunctionType
from typing import NamedTuple

from ..runtime.system.files import changed_ns
from . import STARTED_NS, versions
from .versions import HOME, Place, is_read, place

SOURCE_DIGITS, VERSION_DIGITS = 24, 12
_OF_THIS_PROCESS = f"{os.getpid()} {STARTED_NS}"


# An import on lines of its own, without another import behind a quote, a bracket or a line's end.
_LINE = re.compile(
    rb"(?<!\\\n)(?<!\\\r\n)^[ \t]*((?:from|import)\b[^\n('\"\\]*(?:\([^)#]*\))?[^\n('\"\\]*)$", re.MULTILINE
)
_CALL = re.compile(rb"\b(?:import_module|__import__)\(\s*['\"](\.*)([\w.]+)['\"]")


class Import(NamedTuple):
    """An import: `import module`, or `from module import name as bound` with `level` dots before the module."""

    module: str
    name: str = ""
    alias: str = ""
    level: int = 0


def imports(source: bytes) -> list[Import]:
    """Return every import in a text, including those in functions and for type checkers, without computed names."""
    call_imports = [Import(name.decode(), level=len(dots)) for dots, name in _CALL.findall(source)]
    return call_imports + [statement for node in _statements(source) for statement in _node_imports(node)]


def definitions(source: bytes) -> frozenset[str]:
    """Return the names that a text defines by an assignment, a function or a class, at any depth."""
    return frozenset(name for node in ast.walk(ast.parse(source)) if (name := _defined_name(node)))


def _defined_name(node: ast.AST) -> str | None:
    if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
        return node.name
    return node.id if isinstance(node, ast.Name) and not isinstance(node.ctx, ast.Load) else None


def _statements(source: bytes) -> list[ast.Import | ast.ImportFrom]:
    """Parse only the import lines, in a sixth of the time, or the whole text if `import` occurs elsewhere."""
    lines = _LINE.findall(source)
    text = b"\n".join(lines)
    if len(_WORD.findall(text)) == len(_WORD.findall(source)):
        try:
            return _select(ast.parse(text).body)
        except SyntaxError:  # prose that looks like an import
            pass
    return _select(ast.walk(ast.parse(source)))


def _select(nodes: Iterable[ast.AST]) -> list[ast.Import | ast.ImportFrom]:
    return [node for node in nodes if isinstance(node, ast.Import | ast.ImportFrom)]


def _node_imports(node: ast.Import | ast.ImportFrom) -> list[Import]:
    if isinstance(node, ast.Import):
        return [Import(name.name) for name in node.names]
    return [Import(node.module or "", name.name, name.asname or name.name, node.level) for name in node.names]


@dataclass(frozen=True)
class Closure:
    """The dependencies of some code."""

    digest: str
    """The SHA-256 of the sources, shortened to `SOURCE_DIGITS`, and that of the versions."""
    modules: tuple[str, ...]
    """The modules whose source is in the digest."""
    versions: Mapping[str, str]
    """The versions of Python and of imported libraries whose source is not read."""
    settled: bool
    """True if all files are older than this process. If one is not, the running code may be its earlier text, and the
    digest is unique to this process."""


def closure(*modules: str, alone: tuple[str, ...] = ()) -> Closure:
    """Return the closure of modules by name; of those in `alone`, only the text counts and not their imports.

    The source of a package is read if it is the modules' own or `tangible_core`, has plugins, or lies outside the
    folders for installed packages; of any other package the version counts. Imports are found in the text: nothing
    runs, imports inside functions count, and imports by a computed name do not. Files are read once in a process.
    """
    return _closure(tuple(start for name in modules if (start := place(name))), alone)


def closure_of_function(function: FunctionType) -> Closure | None:
    """Return the closure of a function's module; None for a function without a file, as in a notebook."""
    file = function.__code__.co_filename
    name, package = (str(function.__globals__.get(variable) or "") for variable in ("__name__", "__package__"))
    return _closure((Place(name, file, package),), ()) if Path(file).is_file() else None


@cache
def _closure(start: tuple[Place, ...], alone: tuple[str, ...]) -> Closure:
    walk = _Walk({here.top for here in start})
    walk.through(start)
    texts = {here.name: _text(here) for here in (*walk.visited, *walk.packages, *map(place, alone)) if here is not None}
    libraries = versions.of_imported(walk.libraries)
    is_settled = all(text.settled for text in texts.values())
    sources = hashlib.sha256()
    for name in sorted(texts):
        sources.update(f"\0{name}\0{len(texts[name].content)}\0".encode() + texts[name].content)
    below = hashlib.sha256(repr((sorted(libraries.items()), "" if is_settled else _OF_THIS_PROCESS)).encode())
    digest = sources.hexdigest()[:SOURCE_DIGITS] + below.hexdigest()[:VERSION_DIGITS]
    return Closure(digest, tuple(sorted(texts)), libraries, is_settled)


@dataclass
class _Walk:
    """A walk from module to module along the imports."""

    own: set[str]  # the top packages that are read wherever they lie
    visited: set[Place] = field(default_factory=set[Place])
    # The packages that only re-export names: their text counts, and not their imports of other names.
    packages: set[Place] = field(default_factory=set[Place])
    libraries: set[str] = field(default_factory=set[str])

    def through(self, start: Iterable[Place]) -> None:
        waiting = [statement for here in start for statement in (*self._above(here.name), here)]
        while waiting:
            here = waiting.pop()
            if here not in self.visited:
                self.visited.add(here)
                waiting += [module for statement in _text(here).imports for module in self._resolve(statement, here)]

    def _resolve(self, each: Import, here: Place) -> Iterator[Place]:
        """Yield the modules that an import runs, down to the one that it names."""
        module = _absolute(each, here)
        top = module.partition(".")[0]
        if top not in self.own and not is_read(top):
            self.libraries.add(top)
            return
        below = place(f"{module}.{each.name}") if each.name else None
        yield from self._above(f"{module}.{each.name}" if below else module)
        if below:
            yield below
        elif target := place(module):
            yield from self._origin(target, each.name)

    def _origin(self, module: Place, name: str) -> Iterator[Place]:
        """Yield the modules from which a package re-exports a name; the module itself if it does more than that."""
        entries = [entry for entry in _text(module).imports if entry.alias == name]
        sources = [entry for entry in entries if _absolute(entry, module) != module.name]  # an example in its docstring
        if name in ("", "*") or not sources or not _only_reexports(module) or name in _definitions(module):
            yield module
            return
        self.packages.add(module)
        for source in sources:
            yield from self._resolve(source, module)

    def _above(self, module: str) -> Iterator[Place]:
        """Yield the packages around a module, which run before it."""
        while module := module.rpartition(".")[0]:
            package = place(module)
            if package and _only_reexports(package):
                self.packages.add(package)
            elif package:
                yield package


def _only_reexports(package: Place) -> bool:
    """Return True if a package's own file only re-exports names, so that its imports do not affect modules in it."""
    return package.is_package and (package.top == HOME or "__getattr__" in _definitions(package))


def _absolute(each: Import, here: Place) -> str:
    if not each.level:
        return each.module
    try:
        return resolve_name("." * each.level + each.module, here.package)
    except ImportError:  # beyond the top package: the import would fail as well
        return here.package


class _Text(NamedTuple):
    content: bytes = b""
    imports: tuple[Import, ...] = ()
    settled: bool = False


@cache
def _definitions(package: Place) -> frozenset[str]:
    try:
        return definitions(_text(package).content)
    except (SyntaxError, ValueError):  # it cannot be imported either
        return frozenset()


@cache
def _text(here: Place) -> _Text:
    """Read a module's file, once in a process, and a package's stub, which lists names imported on first use."""
    file, stub = Path(here.file), Path(here.file).with_suffix(".pyi")
    files = [file, stub] if here.is_package and stub.is_file() else [file]
    try:
        is_settled = max(changed_ns(path.stat()) for path in files) < STARTED_NS
        contents = [path.read_bytes() for path in files]
    except OSError:  # in an archive, or gone: the running code is not known
        return _Text()
    content = b"\n".join(contents)
    if file.suffix != ".py":
        return _Text(content, settled=is_settled)
    try:
        return _Text(content, tuple(statement for path in contents for statement in imports(path)), is_settled)
    except (SyntaxError, ValueError):  # it cannot be imported either
        return _Text(content, settled=is_settled)


_WORD = re.compile(rb"\bimport\b")
