"""Code that is in no file, such as a class in a notebook's cell: told by its source and by all that it names."""

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
from .places import followed

PLAIN = (type(None), bool, int, float, complex, str, bytes)


def source_digest(cls: type) -> str | None:
    """Of a class by its source, by the functions, classes and plain values that it names, and by what these name.

    What comes from a module counts as everywhere: by the module's closure, or by the version of its library. None where
    something cannot be told: source that nobody kept, or an array or an object of the notebook that is named.
    """
    try:
        found = sorted(set(_told(cls.__qualname__, cls, set())))
    except (_UntoldError, OSError, TypeError, SyntaxError):
        return None
    return sha256(repr(found).encode()).hexdigest()[:24]


class _UntoldError(Exception):
    """Something that is named, and whose content nobody can tell."""


def _told(name: str, thing: Any, known: set[int]) -> Iterator[tuple[str, str]]:
    """Names and contents of a thing, and of all that it leads to."""
    if id(thing) in known:
        return
    known.add(id(thing))
    thing = getattr(thing, "py_func", thing)  # what numba compiles
    if isinstance(thing, PLAIN):
        yield name, repr(thing)
    elif isinstance(thing, ModuleType):
        yield name, f"{thing.__name__} {_of_module(thing.__name__)}"
    elif not isinstance(module := getattr(thing, "__module__", None), str):
        raise _UntoldError(name)
    elif _is_library(module) or closure(module).modules:
        yield name, f"{_of_module(module)} {getattr(thing, '__qualname__', thing)}"
    elif isinstance(thing, type | FunctionType):
        yield name, _source(thing)
        for inner, value in _named(thing):
            yield from _told(inner, value, known)
    else:
        raise _UntoldError(name)


def _is_library(module: str) -> bool:
    return module != "__main__" and module.partition(".")[0] in sys.stdlib_module_names


def _of_module(name: str) -> str:
    top = name.partition(".")[0]
    return closure(name).digest if followed(top) else repr(versions.of_imported([top]))


def _named(thing: type | FunctionType) -> Iterator[tuple[str, Any]]:
    """What a class or a function of a notebook names of its module, and a class's bases."""
    functions = [thing] if isinstance(thing, FunctionType) else list(_functions(thing))
    if {name for each in functions for name in each.__code__.co_freevars} - {"__class__"}:
        raise _UntoldError(thing.__qualname__)  # it was made in a function, and knows what that knew
    if isinstance(thing, type):
        yield from ((base.__qualname__, base) for base in thing.__bases__)
    there = vars(sys.modules[thing.__module__])
    code = compile(textwrap.dedent(_source(thing)), "<source>", "exec")
    yield from ((name, there[name]) for name in sorted(set(_names(code))) if name in there)


def _source(thing: type | FunctionType) -> str:
    """Its text. Raises: OSError if nobody kept it."""
    if isinstance(thing, FunctionType):
        return inspect.getsource(thing)
    text = _cell(thing)
    for node in ast.walk(ast.parse(text)):
        if (
            isinstance(node, ast.ClassDef)
            and node.name == thing.__name__
            and (found := ast.get_source_segment(text, node))
        ):
            return found
    raise OSError(f"the source of {thing.__name__} is not known")


def _cell(cls: type) -> str:
    """The text that a class stands in, by one of its functions: a class itself does not say its file."""
    for function in _functions(cls):
        return "".join(linecache.getlines(function.__code__.co_filename))
    raise OSError(f"{cls.__name__} has no function to tell by where it stands")


def _functions(cls: type) -> Iterator[FunctionType]:
    for each in vars(cls).values():
        function = inspect.unwrap(getattr(each, "__func__", each))
        if isinstance(function, FunctionType) and function.__module__ == cls.__module__:
            yield function


def _names(code: CodeType) -> Iterator[str]:
    yield from code.co_names
    for each in code.co_consts:
        if isinstance(each, CodeType):
            yield from _names(each)
