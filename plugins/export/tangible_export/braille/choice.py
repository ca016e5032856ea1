"""The option of exporters for the grade of braille."""

from typing import Literal

from tangible_core.data import Quantities


class BrailleChoice(Quantities):
    """The braille of a file."""

    grade: Literal[1, 2] = 1
    """1 is uncontracted, a letter a cell; 2 contracted, as books are printed, in English, German and French by
    liblouis."""

    @staticmethod
    def in_force(option: "bool | BrailleChoice") -> "BrailleChoice":
        """Return the choice that an option stands for, which may only say whether there is braille."""
        return option if isinstance(option, BrailleChoice) else BrailleChoice()
