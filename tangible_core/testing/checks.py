"""What a check is, and the words that checks are written in."""

from collections.abc import Callable
from typing import Any

from ..errors import TangibleError

Check = Callable[[Any], None]
"""A function that raises CheckFailure when its subject does not keep what the docstring demands."""


class CheckFailure(AssertionError):
    """A method does not keep what its kind promises."""


def demand(kept: Any, otherwise: str) -> None:
    """Fail a check, in words, unless the demand is kept.

    >>> demand(1 + 1 == 3, "one and one make 2")
    Traceback (most recent call last):
    tangible_core.testing.checks.CheckFailure: one and one make 2
    """
    __tracebackhide__ = True  # pytest then shows the check, not this line
    if not kept:
        raise CheckFailure(otherwise)


def refuses(error: type[TangibleError], what: str, attempt: Callable[[], object]) -> None:
    """Demand that an attempt raises this error; any other that it raises goes through."""
    __tracebackhide__ = True
    try:
        attempt()
    except error:
        return
    raise CheckFailure(f"{what} is accepted; it should raise {error.__name__}")
