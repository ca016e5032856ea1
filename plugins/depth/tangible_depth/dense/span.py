"""A range of disparities, and the value of an unknown one."""

from typing import NamedTuple

import numpy as np

# Value of an unknown disparity in int16 maps of sixteenths of a pixel: the lowest there is, below any real one.
UNKNOWN = np.int16(-32768)


class Span(NamedTuple):
    """A range of whole disparities, low..high in pixels, both included."""

    low: int
    high: int

    @property
    def size(self) -> int:
        """The number of disparities."""
        return self.high - self.low + 1

    @property
    def lanes(self) -> int:
        """The number of SIMD lanes that hold the disparities: a multiple of 16."""
        return -(-self.size // 16) * 16

    def downsample(self, factor: int) -> "Span":
        """Return the range in pixels of a picture that is smaller by `factor`, rounded outwards."""
        return self if factor == 1 else Span(self.low // factor, -(-self.high // factor))

    def within(self, width: int) -> "Span":
        """Return the part that two columns of a picture of this width can have."""
        low = min(max(self.low, 1 - width), width - 1)
        return Span(low, max(min(self.high, width - 1), low))

    def fill_lanes(self) -> "Span":
        """Extend the upper end until all lanes are used: testing for a limit costs more time than it saves."""
        return Span(self.low, self.low + self.lanes - 1)

    def widen(self) -> "Span":
        """Extend the upper end to a power of two disparities, so that a slightly larger range needs no new kernel."""
        return Span(self.low, self.low + max(16, 1 << (self.size - 1).bit_length()) - 1)
