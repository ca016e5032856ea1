"""The parts of a picture: its connected pieces, each of one segment."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Int32, Integer

from ..errors import PictureError
from .pictures import size_in_words
from .records import Record


@dataclass(frozen=True, eq=False)
class PartMap(Record):
    """Which part each pixel belongs to. A part is a piece of one segment whose pixels hang together by their sides.

    labels: int32 (h, w), numbers of parts from 0, in the order of their first pixels, row by row. On a coarser grid
    (see `parts.reduced_parts`) the numbers are those of the whole picture, and a part may have no pixel there.
    segments: the segment that each part is of.
    Raises: PictureError if a number is none of a part.
    """

    labels: Int32[np.ndarray, "h w"]
    segments: tuple[int, ...]

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.labels.ndim != 2 or self.labels.size == 0:
            raise PictureError(f"parts are numbers (h, w) of at least one pixel, not {self.labels.shape}")
        low, high = int(self.labels.min()), int(self.labels.max())
        if low < 0 or high >= self.count:
            raise PictureError(
                f"the numbers of parts in {size_in_words(self.labels)} pixels run from {low} to {high}, "
                f"and segments are named for {self.count} parts; name one a part"
            )

    @property
    def count(self) -> int:
        """Number of parts."""
        return len(self.segments)


def beside_border(labels: Integer[np.ndarray, "h w"]) -> Bool[np.ndarray, "h w"]:
    """The pixels that share a side with one of another label."""
    across, along = labels[:, 1:] != labels[:, :-1], labels[1:] != labels[:-1]
    found = np.zeros(labels.shape, np.bool_)
    found[:, 1:] |= across
    found[:, :-1] |= across
    found[1:] |= along
    found[:-1] |= along
    return found
