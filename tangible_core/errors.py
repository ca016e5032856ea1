"""The errors that a user can cause; each message includes the cure."""

from collections.abc import Iterable
from difflib import get_close_matches
from math import inf
from numbers import Real
from reprlib import Repr
from sys import stdlib_module_names
from traceback import walk_tb
from typing import Any, NamedTuple

MAX_QUOTED = 80
"""The most characters of a name or a value that a message quotes."""
MAX_IN_LINE = 1000
"""The most characters of a line of a message."""
MAX_LINES = 40
"""The most complaints that are printed; the others are counted."""


class TangibleError(Exception):
    """The base of all errors raised on purpose: the message names the thing, the place and the cure.

    Each argument is a complaint and becomes one line of the message, made printable by `shown`.
    """

    def __str__(self) -> str:
        lines = [shown(str(arg), MAX_IN_LINE) for arg in self.args[:MAX_LINES]]
        if more := len(self.args) - len(lines):
            lines.append(f"and {more} more")
        return "\n".join(lines)


class Complaint(NamedTuple):
    """A mistake in a configuration, for a program that shows it next to the field."""

    location: tuple[str | int, ...]
    """Keys and indices from the top of the file; () for the file as a whole."""
    text: str
    """The complaint in one line, without its place."""
    line: int | None = None
    """The line in the file, from 1; None if the mistake is not in the file."""
    column: int | None = None


class ConfigError(TangibleError):
    """Mistakes in a configuration: one complaint a line, each with its place."""

    def __init__(self, *sentences: object, complaints: Iterable[Complaint] = ()) -> None:
        """Keep the sentences of the message, and the same complaints as records for programs.

        complaints: by default, the sentences without a place.
        """
        super().__init__(*sentences)
        records = tuple(complaints) or tuple(Complaint((), str(sentence)) for sentence in sentences)
        self.complaints: tuple[Complaint, ...] = tuple(
            record._replace(text=shown(record.text, MAX_IN_LINE)) for record in records
        )


class OptionError(ConfigError, ValueError):
    """Options in Python that do not exist, or with a value that they cannot have: one sentence for each."""


class UnknownMethod(TangibleError):
    """A name that no installed method has."""

    def __init__(self, kind: str, name: str, known: Iterable[str], meant: str = "") -> None:
        """meant: the name to suggest where none is spelt like this one."""
        names, name = sorted(set(known)), str(name)
        self.meant: str = _nearest(name, names) or meant  # the name that is suggested
        hint = f" (did you mean {quoted(self.meant)}?)" if self.meant else ""
        there = ", ".join(names) or "none"
        super().__init__(self._sentence(kind, quoted(name), hint, there))

    @staticmethod
    def _sentence(kind: str, name: str, hint: str, there: str) -> str:
        return f"no {kind} method is named {name}{hint}; installed: {there}"


class UnknownName(UnknownMethod):
    """A name that nothing of its kind has, where that is not a method: a product, or a kind of methods."""

    @staticmethod
    def _sentence(kind: str, name: str, hint: str, there: str) -> str:
        return f"no {kind} is named {name}{hint}; known: {there}"


class BrokenMethod(TangibleError):
    """An installed method that cannot be used; the rest of the program works without it."""


class PictureError(TangibleError):
    """A picture or a map that cannot be read or has the wrong content."""


class GeometryError(TangibleError):
    """Numbers that do not describe a camera or a surface."""


class MaterialError(TangibleError):
    """A material, or a mapping of segments to materials, that makes no sense."""


class BrailleError(TangibleError):
    """A text that cannot be written in braille, or does not fit its place."""


class DeviceError(TangibleError):
    """A device that is missing, is in use, or stopped answering."""


class DeviceAbsent(DeviceError):
    """A device that is not connected, or whose driver is not installed: nothing about it can be checked."""


class ModelAbsent(TangibleError):
    """A missing trained network that a method needs: nothing about it can be checked."""


class BatchError(TangibleError):
    """Rows that do not describe scenes, or a cluster that cannot be used."""


class OutputError(TangibleError):
    """Results that cannot be written."""


class Stopped(TangibleError):
    """Work that was stopped from another thread."""

    def __init__(self) -> None:
        super().__init__("stopped on request; what was finished is kept")

    def __reduce__(self) -> tuple[type["Stopped"], tuple[()]]:
        return Stopped, ()  # it is sent from the process that stopped, and takes no arguments


class ResultsError(TangibleError):
    """Files of measurements that are damaged or cannot be compared."""


class ArgumentError(TangibleError, TypeError):
    """An argument of the wrong type that cannot be converted."""


def wrong_argument(name: str, value: object, wanted: str) -> ArgumentError:
    """Return the error for an argument that cannot be used: its name, its value and what it must be.

    >>> wrong_argument("seconds", "long", "a number")
    ArgumentError("seconds: is the str 'long'; it must be a number")
    """
    return ArgumentError(f"{name}: is {what_is(value)}; it must be {wanted}")


def what_is(value: object) -> str:
    """Return a value of the wrong type in words: its type, and the value itself if it is short.

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
    """Raise a ConfigError for a number that is not positive and finite, an ArgumentError for any other value.

    >>> check_positive("seconds", 0.5)
    """
    if not isinstance(value, Real):
        raise wrong_argument(name, value, "a number")
    if not 0 < value < inf:
        raise ConfigError(f"{name}: is {value}; it must be positive and finite")


def exit_error(error: SystemExit) -> BrokenMethod:
    """Return the error for a plugin that called `sys.exit`: a plugin must not end the program."""
    modules = [str(frame.f_globals.get("__name__")) for frame, _ in walk_tb(error.__traceback__)]
    name = next((name for name in reversed(modules) if name.partition(".")[0] not in stdlib_module_names), "a plugin")
    return BrokenMethod(
        f"{name} called sys.exit({quoted(error.code)}); a plugin raises an error that says what is wrong"
    )


def shown(text: str, most: int = MAX_QUOTED) -> str:
    """Return foreign text in a form that a message may hold: one printable line, without the middle of a long text.

    >>> shown("two\\nlines"), shown("x" * 1000, 20)
    ('two\\\\nlines', 'xxxxxxx ... xxxxxxxx')
    """
    text = _without_middle(text, most)
    if text.isprintable():
        return text
    return _without_middle("".join(each if each.isprintable() else repr(each)[1:-1] for each in text), most)


def _without_middle(text: str, most: int) -> str:
    length = most - len(" ... ")
    return text if len(text) <= most else f"{text[: length // 2]} ... {text[-(length - length // 2) :]}"


def quoted(value: Any) -> str:
    """Return a foreign value in a form that a message may quote: its `repr`, cut if it is long or deep.

    >>> quoted("ice"), quoted(list(range(10**6)))
    ("'ice'", '[0, 1, 2, 3, 4, 5, ...]')
    """
    return shown(_REPR.repr(value))


class _ShortRepr(Repr):
    """A short repr by the base type of a value, so that a parser's own mappings are cut like any other."""

    def repr1(self, x: Any, level: int) -> str:
        if isinstance(x, dict):
            return self.repr_dict(x, level)  # pyright: ignore[reportUnknownArgumentType]
        if isinstance(x, list):
            return self.repr_list(x, level)  # pyright: ignore[reportUnknownArgumentType]
        if isinstance(x, str):
            return self.repr_str(x, level)
        if isinstance(x, int) and x.bit_length() > 8 * MAX_QUOTED:  # Python prints no more than 4,300 digits
            return f"a number of {x.bit_length()} bits"
        return super().repr1(x, level)


_REPR = _ShortRepr()
_REPR.maxstring = _REPR.maxother = _REPR.maxlong = MAX_QUOTED
_REPR.maxlevel = 3


def did_you_mean(word: str, known: Iterable[str]) -> str:
    """Return a hint to append to a complaint; "" if no word is close.

    >>> did_you_mean("stifness", ["stiffness", "damping"]), did_you_mean("cat.yaml", ["sky.yaml"])
    (" (did you mean 'stiffness'?)", '')
    """
    near = _nearest(word, known)
    return f" (did you mean {quoted(near)}?)" if near else ""


def _nearest(word: str, known: Iterable[str]) -> str:
    near = get_close_matches(word, list(known), n=1) if len(word) <= MAX_QUOTED else []
    return near[0] if near and _are_near(word, near[0]) else ""


def _are_near(word: str, other: str) -> bool:
    """Return True unless two names have little more in common than an ending, as files of one kind have."""
    (stem, _, ending), (another, _, same) = word.rpartition("."), other.rpartition(".")
    return not stem or ending != same or bool(get_close_matches(stem, [another], n=1))
