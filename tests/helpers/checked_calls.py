"""Types, shapes and dtypes of what every function of ours is given and returns are checked while tests run.

`check` is told once, before any of our modules is imported. What is checked is found in the source: every function of a
module or a class that has annotations, and every dataclass; not what numba compiles, nor what is defined in a function.
"""

import ast
import functools
import hashlib
import io
import sys
import typing
from collections.abc import Callable
from importlib import _bootstrap_external
from importlib.abc import MetaPathFinder
from importlib.machinery import ModuleSpec, PathFinder, SourceFileLoader
from importlib.util import cache_from_source
from pathlib import Path
from types import CodeType
from typing import Any
from unittest.mock import patch

import jaxtyping
from beartype import BeartypeConf, FrozenDict, beartype

OURS = (
    "tangible_core", "tangible_depth", "tangible_texture", "tangible_render", "tangible_devices",
    "tangible_export", "tangible_authoring", "tangible_batch", "tangible_bench", "tangible_report",
    "tangible_legibility", "tangible_networks", "tangible_send", "tangible_study", "tangible_ui", "tangible_web",
)  # fmt: skip
UNCHECKED = {
    "tangible_devices.commands.devices": "typer's Context, as its documentation has it, is given another class's",
    "tangible_core.cli.commands.cache": "likewise",
    "tangible_report.commands.materials": "likewise",
    "tangible_core.cli.commands.plugins": "likewise",
    "tangible_core.provenance.watching": "Python calls it with what is no Sequence, though its stubs say so",
    "tangible_core.servo.ticks.schedule": "its functions are compiled into the loop, as they stand",
}
"""Modules whose calls are not checked, and why."""
CALLS = 1_000
"""So many of each function and process are checked: a simulated device's clock is asked ten million times."""
COMPILED = {"njit", "inner", "intrinsic", "operation", "overload"}
"""What these decorate is compiled, or never called, as by `overload` of typing."""
_VERSION = hashlib.md5(Path(__file__).read_bytes()).hexdigest()
_typed = beartype(
    conf=BeartypeConf(
        is_pep484_tower=True,  # an int is a float, as PEP 484 has it
        hint_overrides=FrozenDict({typing.TextIO: io.TextIOBase, typing.IO[bytes]: io.IOBase}),  # as stubs have it
    )
)


def checked(function: Callable[..., Any]) -> Callable[..., Any]:
    """The function, with its first calls checked; annotations are read at the first, when all names are defined."""
    checking: Callable[..., Any] | None = None
    left = CALLS

    @functools.wraps(function)
    def call(*args: Any, **kwargs: Any) -> Any:
        nonlocal checking, left
        if not left or jaxtyping.config.jaxtyping_disable:
            return function(*args, **kwargs)
        left -= 1
        if checking is None:
            checking = _checking(function)
        return checking(*args, **kwargs)

    return call


def checked_fields(dataclass: type) -> type:
    """The dataclass, with the fields of each new one checked."""
    return jaxtyping.jaxtyped(typechecker=_typed)(dataclass)


def _checking(function: Any) -> Callable[..., Any]:
    function.__annotations__ = {
        name: _hint(annotation, function) for name, annotation in function.__annotations__.items()
    }
    if any(_has_shape(hint) for hint in function.__annotations__.values()):
        return jaxtyping.jaxtyped(typechecker=_typed)(function)
    return _typed(function)  # as strict where there are no shapes, at a tenth of the time


def _hint(annotation: Any, function: Any) -> Any:
    """What an annotation means; anything, where only a type checker can know: `Self`, what is imported for it alone."""
    holder = type("", (), {"__annotations__": {"it": annotation}})
    try:
        hint = typing.get_type_hints(holder, function.__globals__, include_extras=True)["it"]
    except NameError:
        return Any
    if getattr(typing.get_origin(hint), "__module__", "").startswith("pydantic"):
        return typing.get_origin(hint)  # beartype does not know TypeAdapter[...]
    is_vague = getattr(hint, "_is_protocol", False) and not getattr(hint, "_is_runtime_protocol", False)
    return Any if is_vague or hint is typing.Self else hint


def _has_shape(hint: Any) -> bool:
    if isinstance(hint, type) and issubclass(hint, jaxtyping.AbstractArray):
        return True
    return any(_has_shape(arg) for arg in typing.get_args(hint))


def check() -> None:
    """Check the calls of our modules from their first import on."""
    sys.meta_path.insert(0, _Finder())


class _Finder(MetaPathFinder):
    def find_spec(self, name: str, path: Any = None, target: Any = None) -> ModuleSpec | None:
        if name.partition(".")[0] not in OURS or name in UNCHECKED:
            return None
        spec = PathFinder.find_spec(name, path, target)
        if spec is not None and isinstance(spec.loader, SourceFileLoader):
            spec.loader = CheckingLoader(spec.loader.name, spec.loader.path)
        return spec


class CheckingLoader(SourceFileLoader):
    """Of a module whose calls are checked."""

    def get_code(self, fullname: str) -> CodeType | None:
        with patch.object(_bootstrap_external, "cache_from_source", _cached):
            return super().get_code(fullname)

    def source_to_code(self, data: Any, path: Any, *, _optimize: int = -1) -> Any:
        tree = ast.parse(data, path)
        _mark(tree.body)
        tree.body[_start(tree.body) : _start(tree.body)] = ast.parse(
            f"from {__name__} import checked as _checked_, checked_fields as _checked_fields_"
        ).body
        return super().source_to_code(ast.fix_missing_locations(tree), path)


def _cached(path: str, debug_override: None = None) -> str:
    """Where bytecode of a checked module is kept: beside that of others, who must not find it."""
    return cache_from_source(path, optimization=f"checked{_VERSION}")


def _start(body: list[ast.stmt]) -> int:
    """After the docstring and what must come first."""
    first = [isinstance(each, ast.Expr) or getattr(each, "module", None) == "__future__" for each in body]
    return [*first, False].index(False)


def _mark(body: list[ast.stmt]) -> None:
    for node in body:
        names = {_name(each) for each in getattr(node, "decorator_list", [])}
        if isinstance(node, ast.FunctionDef) and _is_annotated(node) and not names & COMPILED:
            node.decorator_list.append(ast.Name("_checked_", ast.Load(), lineno=node.lineno, col_offset=0))
        elif isinstance(node, ast.ClassDef):
            _mark(node.body)
            if "dataclass" in names:
                node.decorator_list.insert(
                    0, ast.Name("_checked_fields_", ast.Load(), lineno=node.lineno, col_offset=0)
                )


def _is_annotated(node: ast.FunctionDef) -> bool:
    given = [*node.args.posonlyargs, *node.args.args, *node.args.kwonlyargs, node.args.vararg, node.args.kwarg]
    return node.returns is not None or any(each and each.annotation for each in given)


def _name(decorator: ast.expr) -> str:
    """`njit` of `@njit`, `@numba.njit` and `@njit(cache=True)`."""
    named = decorator.func if isinstance(decorator, ast.Call) else decorator
    return ast.unparse(named).rpartition(".")[2]
