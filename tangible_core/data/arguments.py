"""Conversion of arguments to the types that records and methods need, with one clear sentence where it fails."""

import math
from collections.abc import Callable, Mapping, Sequence
from functools import wraps
from inspect import Parameter, Signature, signature
from os import PathLike
from typing import Any, TypeVar, Unpack, cast, get_args, get_origin

import numpy as np

from ..errors import ArgumentError, did_you_mean, wrong_argument
from .device import Force, HapticState

NUMBERS = "buif"
F = TypeVar("F", bound=Callable[..., Any])
C = TypeVar("C", bound=type)
_LEFT_OUT = type("LeftOut", (str,), {"__repr__": str.__str__})("...")  # help() shows Python's own as `Ellipsis`
READERS = "; Scene and numpy.load read files"


def named_options(function: F) -> F:
    """Wrap a function so that an unknown option is an ArgumentError with the name that was probably meant."""
    plain = signature(function)
    parameters = [option for parameter in plain.parameters.values() for option in _unpack(parameter)]
    names = [each.name for each in parameters if each.kind in _BY_NAME and each.name not in ("self", "cls")]

    @wraps(function)
    def call(*arguments: Any, **options: Any) -> Any:
        for name in options:
            if name not in names:
                near = did_you_mean(name, names)
                raise ArgumentError(f"{function.__qualname__}: {name}: unknown option{near}; known: {', '.join(names)}")
        return function(*arguments, **options)

    cast(Any, call).__signature__ = plain.replace(parameters=parameters)
    return cast(F, call)


def _unpack(parameter: Parameter) -> Sequence[Parameter]:
    """Return the options that `**options: Unpack[...]` stands for, each by its name and type; others as they are."""
    if get_origin(parameter.annotation) is not Unpack:
        return [parameter]
    types = get_args(parameter.annotation)[0].__annotations__
    return [Parameter(name, Parameter.KEYWORD_ONLY, default=_LEFT_OUT, annotation=types[name]) for name in types]


def named_fields(cls: C) -> C:
    """Let a dataclass raise an ArgumentError, with its fields, for one that is unknown, missing or given twice."""
    build = cast(Any, cls).__init__
    takes = signature(build)
    names = list(takes.parameters)[1:]

    @wraps(build)
    def init(self: object, *values: Any, **fields: Any) -> None:
        try:
            takes.bind(self, *values, **fields)
        except TypeError as error:
            what = _field_mistake(takes, names, len(values), fields)
            raise ArgumentError(f"{cls.__name__}: {what}; its fields: {', '.join(names)}") from error
        build(self, *values, **fields)

    cast(Any, cls).__init__ = init
    return cls


def _field_mistake(takes: Signature, names: Sequence[str], values: int, fields: Mapping[str, Any]) -> str:
    """Return what is wrong with the arguments of a dataclass, of which `values` are given by place."""
    if unknown := next((name for name in fields if name not in names), None):
        return f"{unknown}: unknown field{did_you_mean(unknown, names)}"
    if values > len(names):
        return f"is given {values} values"
    if twice := next((name for name in names[:values] if name in fields), None):
        return f"{twice}: is given twice"
    without_default = [name for name in names[values:] if takes.parameters[name].default is Parameter.empty]
    return f"{next(name for name in without_default if name not in fields)}: is missing"


_BY_NAME = (Parameter.POSITIONAL_OR_KEYWORD, Parameter.KEYWORD_ONLY)


def as_array(name: str, value: object, dtype: str | None = None) -> np.ndarray:
    """Return an array of numbers of this type, or of its own without one. Raises: ArgumentError."""
    if isinstance(value, np.ndarray) and dtype is None:
        return cast(np.ndarray, value)
    array = _plain_array(name, cast(Any, value))
    if dtype is None or array.dtype == dtype:
        return array
    with np.errstate(all="ignore"):
        result = array.astype(dtype)
        fits = result.dtype.kind == "f" or bool(np.all(result == array))
    if not fits:
        raise wrong_argument(name, array, f"an array of {dtype}, which cannot hold some of its {array.dtype} numbers")
    return result


def _plain_array(name: str, value: object) -> np.ndarray:
    if isinstance(value, np.ndarray):
        array = cast(np.ndarray, value)
    elif isinstance(value, str | bytes | PathLike | dict) or value is None:
        raise _not_an_array(name, cast(Any, value))
    else:
        try:
            array = np.asarray(value)
        except (ValueError, TypeError) as error:  # such as rows of different lengths
            raise _not_an_array(name, value) from error
    if array.dtype.kind not in NUMBERS:
        raise _not_an_array(name, cast(Any, value))
    return array


def _not_an_array(name: str, value: object) -> ArgumentError:
    read = READERS if isinstance(value, str | PathLike) else ""
    return wrong_argument(name, cast(Any, value), f"an array of numbers{read}")


def as_picture(name: str, value: Any) -> np.ndarray:
    """Return an array that may be a picture; whole numbers of a list get the smallest unsigned type that holds them."""
    array = as_array(name, value)
    if isinstance(value, list | tuple) and array.dtype.kind == "i" and array.size and array.min() >= 0:
        return array.astype(np.min_scalar_type(array.max()))
    return array


def as_state(state: Any) -> HapticState:
    """Return a state of the tip; three numbers are a position at rest. Raises: ArgumentError."""
    if isinstance(state, HapticState):
        return state
    if (position := _three(state)) is None:
        raise wrong_argument("state", state, "a HapticState, or three numbers: x, y and z in metres")
    return HapticState(position)


def as_force(force: Any) -> Force | None:
    """Return three numbers as a force; None for any other value."""
    numbers = _three(force)
    return None if numbers is None else Force(*numbers)


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
    """Return the value itself if it is a number of any type. Raises: ArgumentError."""
    try:
        if not isinstance(value, str | bytes):
            math.isnan(value)
            return value
    except TypeError:
        pass
    raise wrong_argument(name, value, "a number")
