"""Errors that nobody foresaw, in one sentence: whose plugin failed, in which verb, and where the traceback is."""

import logging
from traceback import walk_tb
from types import FrameType
from typing import Any, NamedTuple

from ..errors import MOST_IN_LINE, shown
from ..runtime.failure_log import where_kept
from .interfaces import KINDS, Link, Touch
from .naming import named, package, points

log = logging.getLogger(__name__)
OURS = package(__name__)
_PLACE = "tangible_place"
"""Of an error that was sent by another process: what its traceback said there."""


class Place(NamedTuple):
    """Where in a plugin an error came from."""

    kind: str
    """Of the plugin; empty where it is not known."""
    module: str
    owner: str
    """The class; empty for a function of the module."""
    function: str


def place_of(error: BaseException) -> Place | None:
    """The innermost call of a plugin that an error went through; None if it went through none."""
    if isinstance(found := getattr(error, _PLACE, None), Place):
        return found
    frames = [frame for frame, _ in walk_tb(error.__traceback__)][::-1]
    return next(filter(None, map(_method, frames)), None) or _function(frames)


def remember_place(error: BaseException, trace: str) -> None:
    """For an error that is sent to another process, where its traceback is not known."""
    setattr(error, _PLACE, place_of(error))
    error.add_note(f"In the process that it came from:\n\n{trace}")


def sentence(error: BaseException) -> str:
    """What a person is told of an error; its traceback is kept in a file."""
    place, text = place_of(error), shown(str(error), MOST_IN_LINE // 2)
    what = f"{type(error).__name__}: {text}" if text else type(error).__name__
    log.debug("the traceback", exc_info=error)
    if place is None:
        return f"tangible itself failed: {what}; please report it: {where_kept(error)}"
    who = named(place.kind, place.module, place.owner)
    return f"{who} failed in {place.function}: {what}; {where_kept(error)}"


def _method(frame: FrameType) -> Place | None:
    """A method of a plugin's object, whether the plugin or a base of its wrote it."""
    owner = frame.f_locals.get("self")
    kind, module = _kind(owner), type(owner).__module__
    if not kind or package(module) == OURS:
        return None
    return Place(kind, module, type(owner).__qualname__, frame.f_code.co_name)


def _function(frames: list[FrameType]) -> Place | None:
    """The innermost function of a package that plugins live in, whatever it belongs to."""
    packages = {package(each.module) for each in points()} - {OURS}
    names = [(str(frame.f_globals.get("__name__")), frame.f_code.co_name) for frame in frames]
    return next((Place("", module, "", name) for module, name in names if package(module) in packages), None)


def _kind(thing: Any) -> str:
    kinds: dict[type, str] = {wanted: kind for kind, wanted in KINDS.items()} | {Touch: "render", Link: "device"}
    return next((kind for wanted, kind in kinds.items() if isinstance(thing, wanted)), "")
