"""What all records are: frozen, of read-only arrays, with a digest of their content."""

from collections.abc import Iterator
from dataclasses import fields, is_dataclass
from importlib import import_module
from typing import Any, cast

import numpy as np
import xxhash

from .fields import settle


class Record:
    """Base of the frozen records: read-only arrays and a digest of the content.

    A record keeps read-only views of the arrays it is given, not copies: whoever made them leaves them alone. What is
    not of a field's type is converted (a list to an array, float64 to float32).
    Raises: ArgumentError for what nothing can be made of.
    """

    def __post_init__(self) -> None:
        settle(self)
        for name, value in items_of(self):
            if isinstance(value, np.ndarray):
                view = cast(np.ndarray, value).view()
                view.flags.writeable = False
                object.__setattr__(self, name, view)

    def _repr_html_(self) -> str:
        """A small picture with units, for a notebook."""
        home = __name__.partition(".")[0]
        return import_module(f"{home}.pipeline.output.notebook").as_html(self)  # what draws lies above what is drawn

    def digest(self) -> str:
        """XXH3-128 of the content, the same in every process; records of equal content have equal digests."""
        return digest_of(self)


def digest_of(value: Any) -> str:
    """XXH3-128 of a record, an array, or plain values and tuples of these; far faster than a cryptographic hash."""
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
        for name, part in items_of(value):
            state.update(f"/{name}=".encode())
            _feed(state, part)
    elif isinstance(value, tuple):
        state.update(f"tuple{len(value)}".encode())  # pyright: ignore[reportUnknownArgumentType]
        for part in value:  # pyright: ignore[reportUnknownVariableType]
            _feed(state, part)
    else:
        state.update(f"{type(value).__name__}:{value!r};".encode())


def items_of(record: Any) -> Iterator[tuple[str, Any]]:
    """Names and values of a record's fields, in order."""
    return ((f.name, getattr(record, f.name)) for f in fields(record))
