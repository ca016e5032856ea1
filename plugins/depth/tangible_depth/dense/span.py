"""A range of disparities, and the value that stands for none."""

from typing import NamedTuple

import numpy as np

UNKNOWN = np.int16(-32768)
"""A disparity that is not known, in maps of sixteenths of a pixel."""


class Span(NamedTuple):
    """The disparities low..high, both included."""

    low: int
    high: int

    @property
    def size(self) -> int:
        """How many disparities."""
        return self.high - self.low + 1

    @property
    def lanes(self) -> int:
        """Lanes that hold them: a multiple of 16."""
        return -(-self.size // 16) * 16

    def shrunk(self, factor: int) -> "Span":
        """In pixels of a picture made smaller by `factor`, none left out."""
        return self if factor == 1 else Span(self.low // factor, -(-self.high // factor))

    def within(self, width: int) -> "Span":
        """Without disparities that no two columns of a picture of this width can have."""
        low = min(max(self.low, 1 - width), width - 1)
        return Span(low, max(min(self.high, width - 1), low))

    def filled(self) -> "Span":
        """With as many larger disparities as the lanes hold anyway: limits cost more than they save."""
        return Span(self.low, self.low + self.lanes - 1)

    def roomy(self) -> "Span":
        """With larger disparities up to a power of two of them, so that what changes a little needs no other kernel."""
        return Span(self.low, self.low + max(16, 1 << (self.size - 1).bit_length()) - 1)
