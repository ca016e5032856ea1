"""Python processes of our own: they run the code that this process runs, found where this one found it.

A child starts with `-P` and takes over `sys.path` as it is here before it imports anything of ours, so that a file in
the current folder is no module of its. What is sent to it by `dumps` names with each class and function the file that
it comes from here; a child whose own import finds another file refuses it.
"""

import io
import os
import pickle
import sys
from collections.abc import Callable
from importlib import import_module
from importlib.machinery import ModuleSpec
from operator import attrgetter
from pathlib import Path
from types import FunctionType, ModuleType
from typing import Any, NamedTuple

from ..errors import BrokenMethod

MAIN = "__main__"
FLAGS = {"isolated": "-I", "ignore_environment": "-E", "no_user_site": "-s", "no_site": "-S"}
"""Of `sys.flags`: what this Python was told to leave out, a child leaves out as well."""


class Place(NamedTuple):
    """Where this process has a class or a function from."""

    module: str
    name: str
    file: str
    """Of the module; empty for one that is part of Python, or of a notebook."""


def is_alive(process: int) -> bool:
    """Whether a process of this number runs, anybody's."""
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    except PermissionError:
        return True
    return True


def command(module: str) -> list[str]:
    """Words that start Python and call `main()` of a module."""
    return python(f"import {module} as child; child.main()")


def python(code: str) -> list[str]:
    """Words that start Python on a piece of code, which finds modules where this process finds them."""
    flags = [flag for name, flag in FLAGS.items() if getattr(sys.flags, name)]
    return [sys.executable, "-P", *flags, "-c", f"import sys; sys.path[:] = {search_path()!r}; {code}"]


def search_path() -> list[str]:
    """`sys.path` for a child, made absolute.

    The empty entry of an interactive Python stands for whatever folder is the current one now. It is handed on only if
    a module of this process lies there: who works beside a file `law.py` feels it, and who merely opened Python in a
    folder of downloads runs nothing of it.
    """
    return [os.path.abspath(entry) for entry in sys.path if entry or _works_here()]  # noqa: PTH100 - as site does it


def _works_here() -> bool:
    """Whether a module that is imported here lies directly in the current folder."""
    try:
        here = Path.cwd()
    except FileNotFoundError:
        return False
    top = [module for name, module in list(sys.modules.items()) if "." not in name and name != MAIN]
    return any(Path(found).parent == here for module in top for found in _places(module))


def _places(module: ModuleType) -> list[str]:
    """Its file, or the folders of a package."""
    spec: ModuleSpec | None = getattr(module, "__spec__", None)
    if spec is None:
        return []
    return list(spec.submodule_search_locations or ([spec.origin] if spec.has_location and spec.origin else []))


def place(module: str, name: str) -> Place:
    """Where a name of a module that is imported here comes from."""
    return Place(module, name, _file(sys.modules.get(module)))


def _file(module: ModuleType | None) -> str:
    return getattr(module, "__file__", None) or ""


def imported(module: str, name: str, file: str) -> Any:
    """What a place holds, imported here.

    Raises: BrokenMethod if there is no such thing here, or if the module is another file than where it was sent from.
    """
    try:
        here = import_module(module)
        found = attrgetter(name)(here)
    except (ImportError, AttributeError) as error:
        raise BrokenMethod(f"{_named(module, name, file)}: {error}; {_cure(module)}") from error
    if file and os.path.realpath(_file(here)) != os.path.realpath(file):
        raise BrokenMethod(f"{_named(module, name, file)}: there it is {_file(here) or 'nothing'}; {_cure(module)}")
    return found


def _named(module: str, name: str, file: str) -> str:
    return f"{name} of {file or module} cannot be had in the process that was started for it"


def _cure(module: str) -> str:
    if module == MAIN:
        return "what a notebook or the script itself defines has to move to a module, a file of its own"
    return f"have one {module.partition('.')[0]} only, where both find it"


def dumps(thing: Any, keep: Callable[[pickle.PickleBuffer], Any] | None = None) -> bytes:
    """A pickle for a child; it is read by `pickle.loads`, which imports nothing from another file than here.

    keep: takes the large buffers, which are then no part of the pickle. Raises: whatever pickle raises.
    """
    file = io.BytesIO()
    _Pickler(file, 5, buffer_callback=keep).dump(thing)
    return file.getvalue()


class _Pickler(pickle.Pickler):
    """Writes classes and functions as calls of `imported`."""

    def reducer_override(self, thing: Any, /) -> Any:
        if not isinstance(thing, type | FunctionType) or thing is imported:
            return NotImplemented
        module = sys.modules.get(thing.__module__)
        try:
            known = module is not None and attrgetter(thing.__qualname__)(module) is thing
        except AttributeError:
            known = False
        if not known:  # pickle knows best what to say of it
            return NotImplemented
        where = place(thing.__module__, thing.__qualname__)
        return (imported, tuple(where)) if where.file or where.module == MAIN else NotImplemented
