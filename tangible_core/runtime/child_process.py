"""Child processes of Python that run the same code as this process, found in the same files."""

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
from typing import IO, Any, NamedTuple

from ..errors import BrokenMethod

MAIN = "__main__"
# Attributes of `sys.flags` -> options of Python that a child gets as well.
FLAGS = {"isolated": "-I", "ignore_environment": "-E", "no_user_site": "-s", "no_site": "-S"}


class Place(NamedTuple):
    """The origin of a class or a function in this process."""

    module: str
    name: str
    file: str
    """The file of the module; "" for a module of Python, or a notebook."""


def command(module: str) -> list[str]:
    """Return the command that starts Python and calls `main()` of a module."""
    return python(f"import {module} as child; child.main()")


def python(code: str) -> list[str]:
    """Return the command that runs code in a Python that finds modules where this process finds them."""
    flags = [flag for name, flag in FLAGS.items() if getattr(sys.flags, name)]
    return [sys.executable, "-P", *flags, "-c", f"import sys; sys.path[:] = {search_path()!r}; {code}"]


def pipe_end(end: IO[bytes] | None) -> IO[bytes]:
    """Return an end of a pipe of a process that was started with pipes."""
    assert end is not None
    return end


def search_path() -> list[str]:
    """Return `sys.path` for a child, made absolute.

    The empty entry of an interactive Python stands for the current folder. It is passed on only if this process has
    imported a module from there: a user who works next to a file `law.py` can use it, and a user who merely opened
    Python in a folder of downloads runs nothing of it.
    """
    return [os.path.abspath(entry) for entry in sys.path if entry or _uses_current_folder()]  # noqa: PTH100 - as site does it


def _uses_current_folder() -> bool:
    """Return True if an imported module lies directly in the current folder."""
    try:
        here = Path.cwd()
    except FileNotFoundError:
        return False
    top = [module for name, module in list(sys.modules.items()) if "." not in name and name != MAIN]
    return any(Path(file).parent == here for module in top for file in _files(module))


def _files(module: ModuleType) -> list[str]:
    """Return a module's file, or a package's folders."""
    spec: ModuleSpec | None = getattr(module, "__spec__", None)
    if spec is None:
        return []
    return list(spec.submodule_search_locations or ([spec.origin] if spec.has_location and spec.origin else []))


def place(module: str, name: str) -> Place:
    """Return the origin of a name of an imported module."""
    return Place(module, name, _file(sys.modules.get(module)))


def _file(module: ModuleType | None) -> str:
    return getattr(module, "__file__", None) or ""


def import_from(module: str, name: str, file: str) -> Any:
    """Import the object of a place."""
    try:
        here = import_module(module)
        value = attrgetter(name)(here)
    except (ImportError, AttributeError) as error:
        raise BrokenMethod(f"{_refusal(module, name, file)}: {error}; {_cure(module)}") from error
    if file and os.path.realpath(_file(here)) != os.path.realpath(file):
        raise BrokenMethod(
            f"{_refusal(module, name, file)}: there the module is {_file(here) or 'nothing'}; {_cure(module)}"
        )
    return value


def _refusal(module: str, name: str, file: str) -> str:
    return f"{name} of {file or module} cannot be imported by the process that was started for it"


def _cure(module: str) -> str:
    if module == MAIN:
        return "move definitions of a notebook or a script to a module in a file of its own"
    return f"install one {module.partition('.')[0]} only, where both processes find it"


def dumps(thing: Any, keep: Callable[[pickle.PickleBuffer], Any] | None = None) -> bytes:
    """Pickle an object for a child, which refuses modules of other files; `keep` takes the large buffers."""
    file = io.BytesIO()
    _Pickler(file, 5, buffer_callback=keep).dump(thing)
    return file.getvalue()


class _Pickler(pickle.Pickler):
    """A pickler that writes classes and functions as calls of `import_from`."""

    def reducer_override(self, thing: Any, /) -> Any:
        if not isinstance(thing, type | FunctionType) or thing is import_from:
            return NotImplemented
        module = sys.modules.get(thing.__module__)
        try:
            is_module_level = module is not None and attrgetter(thing.__qualname__)(module) is thing
        except AttributeError:
            is_module_level = False
        if not is_module_level:  # pickle has the better message
            return NotImplemented
        where = place(thing.__module__, thing.__qualname__)
        return (import_from, tuple(where)) if where.file or where.module == MAIN else NotImplemented
