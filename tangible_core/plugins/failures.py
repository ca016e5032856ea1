"""Unforeseen errors in one sentence: the plugin that failed, the verb, and the file with the traceback."""

import logging
import re
import sys
from collections.abc import Generator
from contextlib import contextmanager
from errno import ENOMEM
from importlib.util import find_spec
from traceback import walk_tb
from types import FrameType
from typing import Any, NamedTuple

from ..errors import MAX_IN_LINE, TangibleError, shown
from ..runtime.failure_log import where_kept
from .interfaces import KINDS, Link, Touch
from .naming import package, plugin_name, points

log: logging.Logger = logging.getLogger(__name__)
OURS = package(__name__)
PACKAGES = {
    "PIL": "pillow",
    "cv2": "opencv-contrib-python-headless",
    "resvg_py": "resvg-py",
    "ruamel": "ruamel.yaml",
    "skimage": "scikit-image",
    "usb": "pyusb",
}
NO_MEMORY = re.compile("failed to map segment|[Cc]annot allocate memory|Insufficient memory")
"""What the system's loader, the C library and OpenCV say when the memory runs out."""
_PLACE = "tangible_place"  # the attribute of an error from another process that holds its place there


class Place(NamedTuple):
    """The place in a plugin that raised an error."""

    kind: str
    """The kind of the plugin; empty where it is unknown."""
    module: str
    owner: str
    """The class; empty for a function of the module."""
    function: str


def find_place(error: BaseException) -> Place | None:
    """Find the innermost call of a plugin in an error's traceback; None without such a call."""
    if isinstance(place := getattr(error, _PLACE, None), Place):
        return place
    frames = [frame for frame, _ in walk_tb(error.__traceback__)][::-1]
    return next(filter(None, map(_method, frames)), None) or _function(frames)


@contextmanager
def naming_plugins() -> Generator[None]:
    """Add the plugin that failed, and its verb, to an unforeseen error: Python prints them below the error."""
    try:
        yield
    except TangibleError:
        raise
    except Exception as error:
        if place := find_place(error):
            text = f"{plugin_name(place.kind, place.module, place.owner)} failed in {place.function}"
            if text not in getattr(error, "__notes__", ()):
                error.add_note(text)
        raise


def remember_place(error: BaseException, trace: str) -> None:
    """Attach place and traceback to an error that is sent to another process, which cannot see its frames."""
    setattr(error, _PLACE, find_place(error))
    error.add_note(f"In the process that it came from:\n\n{trace}")


def sentence(error: BaseException) -> str:
    """Describe an error in a sentence for a person, and write its traceback to a file."""
    place, text = find_place(error), shown(str(error), MAX_IN_LINE // 2)
    if missing := missing_package(error):
        who = "tangible" if place is None else plugin_name(place.kind, place.module, place.owner)
        return f"{who} needs the package {missing}, which is not installed; pip install {missing}"
    what = f"{type(error).__name__}: {text}" if text else type(error).__name__
    log.debug("the traceback", exc_info=error)
    if lacks_memory(error):
        who = "tangible" if place is None else plugin_name(place.kind, place.module, place.owner)
        return f"{who} ran out of memory ({what}); end other programs, choose a smaller picture, or allow more memory"
    if place is None:
        return f"tangible itself failed: {what}; please report it: {where_kept(error)}"
    name = plugin_name(place.kind, place.module, place.owner)
    return f"{name} failed in {place.function}: {what}; {where_kept(error)}"


def lacks_memory(error: BaseException | None) -> bool:
    """Return True if an error, or one that it came from, is that the memory ran out: an import has its own for that.

    >>> lacks_memory(ImportError("c.so: failed to map segment from shared object")), lacks_memory(ImportError("c.so"))
    (True, False)
    """
    while error is not None:
        if isinstance(error, MemoryError) or getattr(error, "errno", 0) == ENOMEM or NO_MEMORY.search(str(error)):
            return True
        error = error.__cause__ or error.__context__
    return False


def missing_package(error: BaseException) -> str | None:
    """Return the package whose absence made an import fail; None for any other error.

    >>> missing_package(ModuleNotFoundError("No module named 'acme'", name="acme.arm"))
    'acme'
    """
    module = (error.name or "").partition(".")[0] if isinstance(error, ModuleNotFoundError) else ""
    if not module or module in sys.stdlib_module_names or find_spec(module):
        return None
    return PACKAGES.get(module, module)


def _method(frame: FrameType) -> Place | None:
    """Find the method of a plugin's object that this frame runs, its own or of a base class."""
    owner = frame.f_locals.get("self")
    kind, module = _kind(owner), type(owner).__module__
    if not kind or package(module) == OURS:
        return None
    return Place(kind, module, type(owner).__qualname__, frame.f_code.co_name)


def _function(frames: list[FrameType]) -> Place | None:
    """Find the innermost function in a package that has plugins."""
    packages = {package(point.module) for point in points()} - {OURS}
    names = [(str(frame.f_globals.get("__name__")), frame.f_code.co_name) for frame in frames]
    return next((Place("", module, "", name) for module, name in names if package(module) in packages), None)


def _kind(thing: Any) -> str:
    kinds: dict[type, str] = {cls: kind for kind, cls in KINDS.items()} | {Touch: "render", Link: "device"}
    return next((kind for cls, kind in kinds.items() if isinstance(thing, cls)), "")
