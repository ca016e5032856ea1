"""Everything a user can cause, each with the words to put it right."""

from collections.abc import Iterable
from difflib import get_close_matches
from math import inf
from numbers import Real
from reprlib import Repr
from sys import stdlib_module_names
from traceback import walk_tb
from typing import Any, NamedTuple

MOST_QUOTED = 80
"""Characters of a name or a value that a message quotes."""
MOST_IN_LINE = 1000
"""Characters of a line of a message, whatever stands in it."""
MOST_LINES = 40
"""Complaints that are printed; of the others, how many they are."""


class TangibleError(Exception):
    """Base of all errors raised on purpose: the message names the thing, the place and the cure.

    Each argument is a complaint and one line of the message, whatever of a file or a name stands in it: see `shown`.
    """

    def __str__(self) -> str:
        lines = [shown(str(each), MOST_IN_LINE) for each in self.args[:MOST_LINES]]
        if more := len(self.args) - len(lines):
            lines.append(f"and {more} more")
        return "\n".join(lines)


class Complaint(NamedTuple):
    """One thing that is wrong in a configuration, for a program that shows it beside the field."""

    location: tuple[str | int, ...]
    """Keys and indices from the top of the file; () for the file as a whole."""
    text: str
    """One line, without its place."""
    line: int | None = None
    """Of the text, from 1; None where it does not stand there."""
    column: int | None = None


class ConfigError(TangibleError):
    """What is wrong in a configuration: one complaint a line, each with its place."""

    def __init__(self, *sentences: object, complaints: Iterable[Complaint] = ()) -> None:
        """complaints: the same for a program; those that have no place of their own need none."""
        super().__init__(*sentences)
        found = tuple(complaints) or tuple(Complaint((), str(each)) for each in sentences)
        self.complaints = tuple(each._replace(text=shown(each.text, MOST_IN_LINE)) for each in found)


class UnknownMethod(TangibleError):
    """No installed method has this name."""

    def __init__(self, kind: str, name: str, known: Iterable[str]) -> None:
        names, name = sorted(set(known)), str(name)
        hint, there = did_you_mean(name, names), ", ".join(names) or "none"
        super().__init__(f"no {kind} method is named {quoted(name)}{hint}; installed: {there}")


class BrokenMethod(TangibleError):
    """A method is installed but cannot be used; the rest goes on without it."""


class PictureError(TangibleError):
    """A picture or a map that cannot be read or does not hold what it should."""


class GeometryError(TangibleError):
    """Numbers that describe no camera or no surface."""


class MaterialError(TangibleError):
    """A material, or a mapping of segments to materials, that makes no sense."""


class BrailleError(TangibleError):
    """A text that cannot be written in braille, or not where it should stand."""


class DeviceError(TangibleError):
    """A device that is not there, is in use, or stopped answering."""


class DeviceAbsent(DeviceError):
    """No such device is connected, or what it is reached by is not installed: nothing can be asked of it."""


class ModelAbsent(TangibleError):
    """A trained network that a method needs is not there: nothing can be asked of it."""


class BatchError(TangibleError):
    """Rows that make no scenes, or a farm that cannot be worked on."""


class OutputError(TangibleError):
    """Results that cannot be written."""


class Stopped(TangibleError):
    """Work that was stopped from another thread."""

    def __init__(self) -> None:
        super().__init__("stopped by the program that asked for it; what was finished is kept")


class ResultsError(TangibleError):
    """Files of measurements that are damaged, or that cannot be compared."""


class ArgumentError(TangibleError, TypeError):
    """An argument of the wrong type that nothing can be made of."""


def wrong_argument(name: str, value: object, wanted: str) -> ArgumentError:
    """What to raise where an argument cannot be used: its name, what it is and what it should be.

    >>> wrong_argument("seconds", "long", "a number")
    ArgumentError("seconds: is the str 'long'; it must be a number")
    """
    return ArgumentError(f"{name}: is {what_is(value)}; it must be {wanted}")


def what_is(value: object) -> str:
    """A value of the wrong type in words: its type, and the value itself where that is short.

    >>> what_is(7), what_is(None), what_is(slice(2))
    ('the int 7', 'None', 'a slice')
    """
    if value is None:
        return "None"
    if (dtype := getattr(value, "dtype", None)) is not None:
        return f"an array of {dtype} {getattr(value, 'shape', '')}"
    if isinstance(value, type):
        return f"the class {value.__name__}"
    name = type(value).__name__
    return f"the {name} {quoted(value)}" if isinstance(value, _SHOWN) else f"a {name}"


_SHOWN = (str, bytes, int, float, complex, tuple, list, dict, set)


def check_positive(name: str, value: float) -> None:
    """Raises: ConfigError for a number that is not positive and finite, ArgumentError for what is no number.

    >>> check_positive("seconds", 0.5)
    """
    if not isinstance(value, Real):
        raise wrong_argument(name, value, "a number")
    if not 0 < value < inf:
        raise ConfigError(f"{name}: is {value}; it must be positive and finite")


def exit_error(error: SystemExit) -> BrokenMethod:
    """What to say where a plugin called `sys.exit`: the program is not a plugin's to end, nor is its exit code."""
    modules = [str(frame.f_globals.get("__name__")) for frame, _ in walk_tb(error.__traceback__)]
    name = next((name for name in reversed(modules) if name.partition(".")[0] not in stdlib_module_names), "a plugin")
    return BrokenMethod(
        f"{name} called sys.exit({quoted(error.code)}); a plugin raises an error that says what is wrong"
    )


def shown(text: str, most: int = MOST_QUOTED) -> str:
    """Somebody else's text as a message may hold it: one line, nothing that a terminal obeys, the middle of a long one
    left out.

    >>> shown("two\\nlines"), shown("x" * 1000, 20)
    ('two\\\\nlines', 'xxxxxxx ... xxxxxxxx')
    """
    text = _without_middle(text, most)
    if text.isprintable():
        return text
    return _without_middle("".join(each if each.isprintable() else repr(each)[1:-1] for each in text), most)


def _without_middle(text: str, most: int) -> str:
    kept = most - len(" ... ")
    return text if len(text) <= most else f"{text[: kept // 2]} ... {text[-(kept - kept // 2) :]}"


def quoted(value: Any) -> str:
    """Somebody else's value as a message may quote it: its `repr`, cut where it is long or deep.

    >>> quoted("ice"), quoted(list(range(10**6)))
    ("'ice'", '[0, 1, 2, 3, 4, 5, ...]')
    """
    return shown(_REPR.repr(value))


class _ShortRepr(Repr):
    """By what a value is, not by the name of its class, so that a parser's own mappings are cut like any."""

    def repr1(self, x: Any, level: int) -> str:
        if isinstance(x, dict):
            return self.repr_dict(x, level)  # pyright: ignore[reportUnknownArgumentType]
        if isinstance(x, list):
            return self.repr_list(x, level)  # pyright: ignore[reportUnknownArgumentType]
        if isinstance(x, str):
            return self.repr_str(x, level)
        if isinstance(x, int) and x.bit_length() > 8 * MOST_QUOTED:  # Python writes no number of over 4,300 digits
            return f"a number of {x.bit_length()} bits"
        return super().repr1(x, level)


_REPR = _ShortRepr()
_REPR.maxstring = _REPR.maxother = _REPR.maxlong = MOST_QUOTED
_REPR.maxlevel = 3


def did_you_mean(word: str, known: Iterable[str]) -> str:
    """A hint to append to a complaint, empty when nothing is close.

    >>> did_you_mean("stifness", ["stiffness", "damping"])
    " (did you mean 'stiffness'?)"
    """
    near = get_close_matches(word, list(known), n=1) if len(word) <= MOST_QUOTED else []
    return f" (did you mean {quoted(near[0])}?)" if near else ""
