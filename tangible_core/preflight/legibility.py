"""The verdicts on the legibility of parts for fingers."""

from typing import ClassVar

from .preflight import Verdicts, reasons
from .verdict import Grade


class Legibility(Verdicts):
    """The verdicts on parts, in the order of the rules."""

    __slots__ = ()
    good = "readable"
    bad: ClassVar[Grade] = "illegible"

    @property
    def readable(self) -> bool:
        """True if nothing is illegible."""
        return self.grade != self.bad

    @property
    def sentence(self) -> str:
        """A sentence on the result: legible, legible but ..., or illegible because ....

        >>> Legibility().sentence
        'Legible: fingers can read it.'
        """
        if self.grade == "ok":
            return "Legible: fingers can read it."
        return f"{'Legible, but' if self.readable else 'Illegible, because'} {reasons(self)}."
