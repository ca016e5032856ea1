"""How many bytes a folder holds, as told by all processes that write into it, without listing the folder."""

import os
from pathlib import Path

import numpy as np

from ...files.writing import atomic_write

MOST_NUMBERS = 1 << 17
"""Of a longer tally, nothing is known: whoever counts anew makes it short."""


class Tally:
    """A file of numbers whose sum is the bytes in the folder: what was counted, and after it what each writer added.

    Eight bytes are appended at once, which no other writer comes between, so there is no lock. What a process that is
    killed does not add is missed until the folder is counted anew, and what is written twice is counted twice.
    """

    def __init__(self, path: Path) -> None:
        self.path = path

    def add(self, size: int) -> int | None:
        """The sum with this; None where it is not known, and the folder must be counted.

        Raises: OSError if the file cannot be read or written.
        """
        try:
            file = os.open(self.path, os.O_RDWR | os.O_APPEND | getattr(os, "O_BINARY", 0))
        except FileNotFoundError:
            return None
        try:
            os.write(file, size.to_bytes(8, "little"))
            os.lseek(file, 0, os.SEEK_SET)
            told = os.read(file, 8 * MOST_NUMBERS)
        finally:
            os.close(file)
        if len(told) % 8 or len(told) in (8, 8 * MOST_NUMBERS):  # its own alone, or more than is read
            return None
        numbers = np.frombuffer(told, "<i8")
        return None if numbers.min() < 0 else int(numbers.sum())

    def begin(self, total: int) -> None:
        """What was counted: the first number. Raises: OutputError if the file cannot be written."""
        with atomic_write(self.path) as file:
            file.write(total.to_bytes(8, "little"))
