"""The type of a check, and the functions that checks are written with."""

import sys
from collections.abc import Callable
from typing import Any

from ..errors import TangibleError

Check = Callable[[Any], None]
"""A function that raises CheckFailure if a method does not meet the demand of the function's docstring."""


class CheckFailure(AssertionError):
    """A demand of the kit that a method does not meet."""


def demand(met: Any, otherwise: str) -> None:
    """Raise CheckFailure with the message `otherwise` unless the demand is met.

    >>> demand(1 + 1 == 3, "one and one make 2")
    Traceback (most recent call last):
    tangible_core.testing.checks.CheckFailure: one and one make 2
    """
    __tracebackhide__ = True  # pytest then shows the check, not this line
    if not met:
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
    defined = vars(sys.modules[module]).values()
    return tuple(each for each in defined if getattr(each, "__module__", "") == module and each.__name__[0] != "_")
