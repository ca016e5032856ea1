"""Everything a user can cause, each with the words to put it right."""

from collections.abc import Iterable
from difflib import get_close_matches
from sys import stdlib_module_names
from traceback import walk_tb


class TangibleError(Exception):
    """Base of all errors raised on purpose: the message names the thing, the place and the cure."""


class ConfigError(TangibleError):
    """What is wrong in a configuration: one complaint a line, each with its place."""


class UnknownMethod(TangibleError):
    """No installed method has this name."""

    def __init__(self, kind: str, name: str, known: Iterable[str]) -> None:
        names = sorted(set(known))
        super().__init__(
            f"no {kind} method is named {name!r}{did_you_mean(name, names)}; installed: {', '.join(names) or 'none'}"
        )


class BrokenMethod(TangibleError):
    """A method is installed but cannot be used; the rest goes on without it."""


class PictureError(TangibleError):
    """A picture or a map that cannot be read or does not hold what it should."""


class GeometryError(TangibleError):
    """Numbers that describe no camera or no surface."""


class MaterialError(TangibleError):
    """A material, or a mapping of segments to materials, that makes no sense."""


class DeviceError(TangibleError):
    """A device that is not there, is in use, or stopped answering."""


class DeviceAbsent(DeviceError):
    """No such device is connected, or what it is reached by is not installed: nothing can be asked of it."""


class OutputError(TangibleError):
    """Results that cannot be written."""


class ResultsError(TangibleError):
    """Files of measurements that are damaged, or that cannot be compared."""


def exited(error: SystemExit) -> BrokenMethod:
    """What to say where a plugin called `sys.exit`: the program is not a plugin's to end, nor is its exit code."""
    modules = [str(frame.f_globals.get("__name__")) for frame, _ in walk_tb(error.__traceback__)]
    name = next((name for name in reversed(modules) if name.partition(".")[0] not in stdlib_module_names), "a plugin")
    return BrokenMethod(f"{name} called sys.exit({error.code!r}); a plugin says what is wrong by raising an error")


def did_you_mean(word: str, known: Iterable[str]) -> str:
    """A hint to append to a complaint, empty when nothing is close.

    >>> did_you_mean("stifness", ["stiffness", "damping"])
    " (did you mean 'stiffness'?)"
    """
    near = get_close_matches(word, list(known), n=1)
    return f" (did you mean {near[0]!r}?)" if near else ""
