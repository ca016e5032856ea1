"""What a program gives to a record or a method, as what it is wanted as; or one sentence that says what it is instead.

A list becomes an array, and numbers change their type where none of them changes its value by more than its rounding.
"""

import math
from collections.abc import Sequence
from os import PathLike
from typing import Any, cast

import numpy as np

from ..errors import ArgumentError, wrong_argument
from .device import Force, HapticState

NUMBERS = "buif"
"""Kinds of NumPy's types that hold numbers."""
READERS = "; Scene.of and numpy.load read files"


def as_array(name: str, value: object, dtype: str | None = None) -> np.ndarray:
    """An array of numbers, of this type if one is named; an array itself where none is.

    Raises: ArgumentError for what holds no numbers, or numbers that this type cannot hold.
    """
    if isinstance(value, np.ndarray) and dtype is None:
        return cast(np.ndarray, value)
    found = _plain_array(name, cast(Any, value))
    if dtype is None or found.dtype == dtype:
        return found
    with np.errstate(all="ignore"):
        made = found.astype(dtype)
        kept = made.dtype.kind == "f" or bool(np.all(made == found))
    if not kept:
        raise wrong_argument(name, found, f"an array of {dtype}: some of its {found.dtype} numbers are none")
    return made


def _plain_array(name: str, value: object) -> np.ndarray:
    if isinstance(value, np.ndarray):
        found = cast(np.ndarray, value)
    elif isinstance(value, str | bytes | PathLike | dict) or value is None:
        raise _no_array(name, cast(Any, value))
    else:
        try:
            found = np.asarray(value)
        except (ValueError, TypeError) as error:  # such as rows of different lengths
            raise _no_array(name, value) from error
    if found.dtype.kind not in NUMBERS:
        raise _no_array(name, cast(Any, value))
    return found


def _no_array(name: str, value: object) -> ArgumentError:
    read = READERS if isinstance(value, str | PathLike) else ""
    return wrong_argument(name, cast(Any, value), f"an array of numbers{read}")


def as_picture(name: str, value: Any) -> np.ndarray:
    """An array that may be a picture; whole numbers of a list have as few bits as a picture may have.

    Raises: ArgumentError as `as_array`.
    """
    found = as_array(name, value)
    if isinstance(value, list | tuple) and found.dtype.kind == "i" and found.size and found.min() >= 0:
        return found.astype(np.min_scalar_type(found.max()))
    return found


def as_state(state: Any) -> HapticState:
    """Where a tip is; three numbers are a place where it rests. Raises: ArgumentError."""
    if isinstance(state, HapticState):
        return state
    if (place := _three(state)) is None:
        raise wrong_argument("state", state, "a HapticState, or three numbers: x, y and z in metres")
    return HapticState(place)


def as_force(force: Any) -> Force | None:
    """Three numbers as a force; None for what is no three numbers."""
    found = _three(force)
    return None if found is None else Force(*found)


def _three(value: Any) -> tuple[float, float, float] | None:
    if isinstance(value, np.ndarray):
        value = cast(np.ndarray, value).tolist()
    if not isinstance(value, Sequence) or isinstance(value, str | bytes) or len(cast("Sequence[Any]", value)) != 3:
        return None
    try:
        x, y, z = map(float, cast("Sequence[Any]", value))
    except (TypeError, ValueError):
        return None
    return x, y, z


def as_number(name: str, value: Any) -> Any:
    """The value itself, if it is a number, of whatever type. Raises: ArgumentError."""
    try:
        if not isinstance(value, str | bytes):
            math.isnan(value)
            return value
    except TypeError:
        pass
    raise wrong_argument(name, value, "a number")
