"""A large picture as bands of rows, each the bytes of a small picture file, and their reduction."""

from collections.abc import Iterable, Iterator
from typing import NamedTuple

import cv2
import numpy as np

from ....runtime.opencv import plain_opencv

BAND_PIXELS = 4_000_000
"""The pixels of a band, about: what is in memory next to the file and the reduced picture."""


_AVERAGED = ("uint8", "uint16", "float32")
"""Types of numbers that OpenCV averages without another copy."""


class Bands(NamedTuple):
    """A picture file cut into bands."""

    rows: int
    columns: int
    orientation: int
    """Orientation of the camera by EXIF, 1 to 8, which the bands do not state."""
    files: Iterator[bytes]
    """Bands from top to bottom, each the bytes of a picture file as wide as the picture."""


class WholePieceError(ValueError):
    """A large picture is stored so that its rows cannot be decoded one after another; the message names the cure."""


def reduced(bands: Iterable[np.ndarray], rows: int, columns: int, times: int) -> np.ndarray:
    """Return the mean of each square of `times` x `times` pixels, the squares at the right and lower rim cut short.

    bands: (any, columns[, channels]) of one dtype, `rows` rows together. Raises: ValueError if there are fewer.
    """
    small, rest, filled = np.empty(0), np.empty(0), 0
    for band in bands:
        together = np.concatenate([rest, band]) if rest.size else band
        if not small.size:
            small = np.empty((-(-rows // times), -(-columns // times), *band.shape[2:]), band.dtype)
        whole = len(together) // times * times
        filled += _fill(small[filled:], together[:whole], times)
        rest = together[whole:]
    filled += _fill(small[filled:], rest, times)
    if filled < -(-rows // times):
        raise ValueError("its rows end early")
    return small


def _fill(small: np.ndarray, band: np.ndarray, times: int) -> int:
    """Write the means of a band to the first rows of `small`; return how many rows these are."""
    filled = min(-(-len(band) // times), len(small))
    if not filled:
        return 0
    down, right = filled * times - len(band), small.shape[1] * times - band.shape[1]
    numbers = band if band.dtype.name in _AVERAGED else band.astype(np.float64)
    with plain_opencv():
        padded = cv2.copyMakeBorder(numbers, 0, down, 0, right, cv2.BORDER_REPLICATE) if down or right else numbers
        mean = cv2.resize(padded, (small.shape[1], filled), interpolation=cv2.INTER_AREA)
    small[:filled] = mean.reshape(small[:filled].shape)
    return filled
