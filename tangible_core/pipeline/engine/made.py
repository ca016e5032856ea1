"""The record of a product: all that an engine knows of it so far."""

from dataclasses import dataclass
from typing import Any, Final

from ...data import Note

NOT_MADE: Final = object()
"""The value of a product that is not made yet; None is the value of a skipped one."""


@dataclass
class Made:
    """A product of a stage at the steps of its making, each made once and on request."""

    key: str | None = None
    """The text that identifies its content before it is made."""
    value: Any = NOT_MADE
    """The product as the stage or the cache returned it, on the working grid."""
    finished: Any = NOT_MADE
    """The product checked, and with names."""
    full_size: Any = NOT_MADE
    """The finished product for every pixel of the pictures."""
    notes: tuple[Note, ...] | None = None
    """The notes from when it was made, in this process or before; None while unknown."""
