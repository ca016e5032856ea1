"""The type of a check, the functions that checks are written with, and variants of pictures."""

import sys
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from ..data.pictures import to_grey
from ..errors import TangibleError

Check = Callable[[Any], None]
"""A function that raises CheckFailure if a method does not meet the demand of the function's docstring."""


class CheckFailure(AssertionError):
    """A demand of the kit that a method does not meet."""


def demand(is_met: Any, otherwise: str) -> None:
    """Raise CheckFailure with the message `otherwise` unless the demand is met.

    >>> demand(1 + 1 == 3, "one and one make 2")
    Traceback (most recent call last):
    tangible_core.testing.checks.CheckFailure: one and one make 2
    """
    __tracebackhide__ = True  # pytest then shows the check, not this line
    if not is_met:
        raise CheckFailure(otherwise)


def refuses(error: type[TangibleError], what: str, attempt: Callable[[], object]) -> None:
    """Demand that an attempt raises this error; another error that it raises is passed on."""
    __tracebackhide__ = True
    try:
        attempt()
    except error:
        return
    raise CheckFailure(f"{what} is accepted; it should raise {error.__name__}")


def checks_in(module: str) -> tuple[Check, ...]:
    """Return the public functions that a module has defined so far, in their order."""
    values = vars(sys.modules[module]).values()
    return tuple(check for check in values if getattr(check, "__module__", "") == module and check.__name__[0] != "_")


TINY = ((1, 1), (1, 9), (9, 1), (2, 2), (17, 9))
"""Sizes (h, w) at which windows, pyramids and neighbours run out."""


def exact_variants(picture: np.ndarray) -> Iterator[tuple[str, np.ndarray]]:
    """Yield the uint8 (h, w, 3) picture without loss in other types and memory layouts, with their names."""
    yield "uint16", picture.astype(np.uint16) * 257
    yield "float32", np.asarray(picture / 255, np.float32)
    yield "float64", picture / 255
    yield "opaque RGBA", np.dstack([picture, np.full(picture.shape[:2], 255, np.uint8)])
    yield "Fortran order", np.asfortranarray(picture)
    yield "a view with negative strides", np.ascontiguousarray(picture[::-1, ::-1])[::-1, ::-1]


def coarse_variants(picture: np.ndarray) -> Iterator[tuple[str, np.ndarray]]:
    """Yield the uint8 (h, w, 3) picture with less information, or with unusual but finite values, with names."""
    yield "grey", np.rint(to_grey(picture) * 255).astype(np.uint8)
    yield "bool", picture > 127
    yield "float16", np.asarray(picture / 255, np.float16)
    yield "floats over 1", picture.astype(np.float32)
    yield "negative floats", picture / -255
    yield "huge floats", picture * 1e300
