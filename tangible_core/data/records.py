"""The base of all records: frozen, with read-only arrays, fields of the annotated types, and a content digest."""

from collections.abc import Callable, Iterator
from dataclasses import fields, is_dataclass
from functools import cache
from importlib import import_module
from types import NoneType, UnionType
from typing import Any, Literal, Union, cast, get_args, get_origin, get_type_hints

import numpy as np
import xxhash

from ..errors import quoted, wrong_argument
from .arguments import as_array, as_number, as_picture


class Record:
    """The base of the frozen records: read-only arrays and a digest of the content.

    A record keeps read-only views of the arrays that it is given, not copies: do not change them afterwards. A value
    of another type than its field's is converted (a list to an array, float64 to float32).
    Raises: ArgumentError for a value that cannot be converted.
    """

    def __init_subclass__(cls, **options: Any) -> None:
        """Give a record the short form of its fields before `dataclass` gives it the long one."""
        super().__init_subclass__(**options)
        if "__repr__" not in cls.__dict__:
            setattr(cls, "__repr__", short_repr)  # noqa: B010 - an assignment would declare another type of it

    def __post_init__(self) -> None:
        settle(self)
        for name, value in named_values(self):
            if isinstance(value, np.ndarray):
                object.__setattr__(self, name, as_read_only(cast(np.ndarray, value)))

    def _repr_html_(self) -> str:
        home = __name__.partition(".")[0]
        return import_module(f"{home}.pipeline.output.showing").as_html(self)  # the drawing lies on a higher floor

    def digest(self) -> str:
        """Return the XXH3-128 of the content: the same in every process, and equal for equal content."""
        return digest_of(self)


def as_read_only(array: np.ndarray) -> np.ndarray:
    """Return a read-only view of an array."""
    view = array.view()
    view.flags.writeable = False
    return view


def digest_of(value: Any) -> str:
    """Return the XXH3-128 of a record, an array, a plain value or a tuple of these; cryptographic hashes are slower."""
    state = xxhash.xxh3_128()
    _feed(state, value)
    return state.hexdigest()


def _feed(state: Any, value: Any) -> None:
    if isinstance(value, np.ndarray):
        array = cast(np.ndarray, value)
        state.update(f"array{array.shape}{array.dtype.str}".encode())
        state.update(np.ascontiguousarray(array).data)
    elif is_dataclass(value):
        state.update(type(value).__name__.encode())
        for name, part in named_values(value):
            state.update(f"/{name}=".encode())
            _feed(state, part)
    elif isinstance(value, tuple):
        state.update(f"tuple{len(value)}".encode())  # pyright: ignore[reportUnknownArgumentType]
        for part in value:  # pyright: ignore[reportUnknownVariableType]
            _feed(state, part)
    else:
        state.update(f"{type(value).__name__}:{value!r};".encode())


def named_values(record: Any) -> Iterator[tuple[str, Any]]:
    """Return the names and values of a record's fields, in order."""
    return ((f.name, getattr(record, f.name)) for f in fields(record))


# A function from a field's name and a given value to the value that the field holds. Raises: ArgumentError.
Convert = Callable[[str, Any], Any]


def settle(record: Any) -> None:
    """Convert each field of a frozen dataclass to the type of its annotation."""
    for name, convert in _converters(cast(Any, type(record))):
        value_before = getattr(record, name)
        if (value := convert(name, value_before)) is not value_before:
            object.__setattr__(record, name, value)


@cache
def _converters(cls: type) -> tuple[tuple[str, Convert], ...]:
    hints = get_type_hints(cls)
    converters = ((field.name, _converter(hints[field.name])) for field in fields(cast(Any, cls)))
    return tuple((name, convert) for name, convert in converters if convert is not None)


def _converter(hint: Any) -> Convert | None:
    """Return the converter for an annotation; None if it accepts any value."""
    if get_origin(hint) in (Union, UnionType) and len(_parts(hint)) == 1:
        inner = _converter(_parts(hint)[0])
        return inner and (lambda name, value: None if value is None else inner(name, value))
    if get_origin(hint) is Literal:
        return _choice_converter(get_args(hint))
    if get_origin(hint) is tuple:
        return _tuple_converter(get_args(hint))
    if hint is np.ndarray or hasattr(hint, "array_type"):
        dtypes = tuple(getattr(hint, "dtypes", ()))
        return as_picture if len(dtypes) != 1 else lambda name, value: as_array(name, value, dtypes[0])
    if hint is float:
        return as_number
    return _instance_converter(hint) if isinstance(hint, type) and (is_dataclass(hint) or hint is str) else None


def _parts(union: Any) -> list[Any]:
    return [arg for arg in get_args(union) if arg is not NoneType]


def _choice_converter(choices: tuple[Any, ...]) -> Convert:
    def convert(name: str, value: Any) -> Any:
        if value not in choices:
            raise wrong_argument(name, value, f"one of {', '.join(map(str, choices))}")
        return value

    return convert


def _instance_converter(cls: type) -> Convert:
    def convert(name: str, value: Any) -> Any:
        if not isinstance(value, cls):
            raise wrong_argument(name, value, f"a {cls.__name__}")
        return value

    return convert


def _tuple_converter(parts: tuple[Any, ...]) -> Convert:
    one = parts[0] if len(parts) == 2 and parts[1] is ... else None
    each, count = _converter(one or parts[0]), "some" if one else str(len(parts))
    expected = f"{count} {'numbers' if parts[0] is float else f'objects of {parts[0].__name__}'}"

    def convert(name: str, value: Any) -> Any:
        items = _items(value)
        if items is None or (not one and len(items) != len(parts)):
            raise wrong_argument(name, value, expected)
        for i, item in enumerate(items if each else ()):
            cast(Convert, each)(f"{name}[{i}]", item)
        return items

    return convert


def _items(value: object) -> tuple[Any, ...] | None:
    """Return the items of a tuple (itself), a list or an array; None for any other value."""
    if isinstance(value, tuple):
        return cast("tuple[Any, ...]", value)
    if isinstance(value, list | np.ndarray):
        return tuple(cast(Any, value).tolist() if isinstance(value, np.ndarray) else cast("list[Any]", value))
    return None


def short_repr(value: Any) -> str:
    """Return the name of a dataclass's object with its fields that are not at their defaults.

    >>> from tangible_core.data import DisparityMap
    >>> short_repr(DisparityMap(np.arange(6, dtype=np.float32).reshape(2, 3)))
    'DisparityMap(disparity_px=<float32 (2, 3), 0 to 5>, confidence=<float32 (2, 3), 1 to 1>)'
    """
    parts = ((field.name, getattr(value, field.name)) for field in fields(value) if _differs(value, field))
    return f"{type(value).__name__}({', '.join(f'{name}={_shown(part)}' for name, part in parts)})"


def _differs(value: Any, field: Any) -> bool:
    own = getattr(value, field.name)
    return isinstance(own, np.ndarray) or (own is not field.default and own != field.default)


def _shown(value: Any) -> str:
    if isinstance(value, np.ndarray):
        return _in_brief(cast(np.ndarray, value))
    if isinstance(value, tuple):
        return quoted(tuple(getattr(part, "name", part) for part in cast("tuple[Any, ...]", value)))
    return repr(value) if is_dataclass(value) else quoted(value)


def _in_brief(array: np.ndarray) -> str:
    """Return an array's type, shape and range; NaN and infinity are left out of the range."""
    text = f"{array.dtype} {array.shape}"
    finite = array[np.isfinite(array)] if array.dtype.kind in "fc" else array
    if not finite.size or array.dtype.kind not in "buif":
        return f"<{text}>"
    unknown = ", some NaN" if finite.size < array.size else ""
    return f"<{text}, {finite.min():g} to {finite.max():g}{unknown}>"
