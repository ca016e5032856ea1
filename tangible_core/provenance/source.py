"""Digest of code without a file, such as a class in a notebook's cell, by its source and everything it refers to."""

import ast
import inspect
import linecache
import sys
import textwrap
from collections.abc import Iterator
from hashlib import sha256
from types import CodeType, FunctionType, ModuleType
from typing import Any

from . import versions
from .closure import closure
from .versions import is_read

PLAIN = (type(None), bool, int, float, complex, str, bytes)


def source_digest(cls: type) -> str | None:
    """Return a digest of a class: its source, and recursively the functions, classes and plain values it refers to.

    Objects of modules count by the module's closure, or by the version of its library. None if a part cannot be
    digested: a source that was not kept, or an array or an object of the notebook.
    """
    try:
        contents = sorted(set(_contents(cls.__qualname__, cls, set())))
    except (_UnknownContentError, OSError, TypeError, SyntaxError):
        return None
    return sha256(repr(contents).encode()).hexdigest()[:24]


class _UnknownContentError(Exception):
    """A reference to an object whose content cannot be digested."""


def _contents(name: str, thing: Any, visited: set[int]) -> Iterator[tuple[str, str]]:
    """Yield the name and content of an object, and of everything that it refers to."""
    if id(thing) in visited:
        return
    visited.add(id(thing))
    thing = getattr(thing, "py_func", thing)  # of a kernel of numba
    if isinstance(thing, PLAIN):
        yield name, repr(thing)
    elif isinstance(thing, ModuleType):
        yield name, f"{thing.__name__} {_of_module(thing.__name__)}"
    elif not isinstance(module := getattr(thing, "__module__", None), str):
        raise _UnknownContentError(name)
    elif _is_library(module) or closure(module).modules:
        yield name, f"{_of_module(module)} {getattr(thing, '__qualname__', thing)}"
    elif isinstance(thing, type | FunctionType):
        yield name, _source(thing)
        for inner, value in _references(thing):
            yield from _contents(inner, value, visited)
    else:
        raise _UnknownContentError(name)


def _is_library(module: str) -> bool:
    return module != "__main__" and module.partition(".")[0] in sys.stdlib_module_names


def _of_module(name: str) -> str:
    top = name.partition(".")[0]
    return closure(name).digest if is_read(top) else repr(versions.of_imported([top]))


def _references(thing: type | FunctionType) -> Iterator[tuple[str, Any]]:
    """Yield the names of its module that a class or a function of a notebook refers to, and a class's bases."""
    functions = [thing] if isinstance(thing, FunctionType) else list(_functions(thing))
    if {name for function in functions for name in function.__code__.co_freevars} - {"__class__"}:
        raise _UnknownContentError(thing.__qualname__)  # it was defined in a function, and uses its variables
    if isinstance(thing, type):
        yield from ((base.__qualname__, base) for base in thing.__bases__)
    namespace = vars(sys.modules[thing.__module__])
    code = compile(textwrap.dedent(_source(thing)), "<source>", "exec")
    yield from ((name, namespace[name]) for name in sorted(set(_names(code))) if name in namespace)


def _source(thing: type | FunctionType) -> str:
    """Return the text of a class or a function. Raises: OSError if it was not kept."""
    if isinstance(thing, FunctionType):
        return inspect.getsource(thing)
    text = _cell(thing)
    for node in ast.walk(ast.parse(text)):
        if (
            isinstance(node, ast.ClassDef)
            and node.name == thing.__name__
            and (segment := ast.get_source_segment(text, node))
        ):
            return segment
    raise OSError(f"the source of {thing.__name__} is not known")


def _cell(cls: type) -> str:
    """Return the text around a class, by the file of one of its functions: a class has no file."""
    for function in _functions(cls):
        return "".join(linecache.getlines(function.__code__.co_filename))
    raise OSError(f"{cls.__name__} has no function by which its source could be found")


def _functions(cls: type) -> Iterator[FunctionType]:
    for attribute in vars(cls).values():
        function = inspect.unwrap(getattr(attribute, "__func__", attribute))
        if isinstance(function, FunctionType) and function.__module__ == cls.__module__:
            yield function


def _names(code: CodeType) -> Iterator[str]:
    yield from code.co_names
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            yield from _names(constant)
