"""Pairs whose two views stand in one file."""

from pathlib import Path
from typing import Literal, NamedTuple

import numpy as np

from ...data.pictures import size_in_words
from ...errors import PictureError
from .decoding import bytes_of, decode, look_at, values_of
from .multi_picture import Notify, ignore, view_numbers
from .pictures import NonFinite, picture_of

Layout = Literal["side-by-side", "cross-eyed", "top-bottom"]


class Pair(NamedTuple):
    """The two views of a file."""

    left: np.ndarray
    right: np.ndarray


def read_pair(
    path: Path, layout: Layout | None = None, non_finite: NonFinite = "error", notify: Notify = ignore
) -> Pair:
    """Read the left and right view of one file: the two pictures of an .mpo file, or the halves of one picture.

    layout: the order of the halves; None: the order that a .jps file states.
    Raises: PictureError as `read_picture`, or if there are no halves.
    """
    data = bytes_of(path)
    if layout is None and path.suffix.lower() not in (".npy", ".npz"):
        numbers = look_at(path, data, lambda image: view_numbers(image) if image.format == "MPO" else [])
        if len(numbers) > 1:
            left, right = (picture_of(decode(path, data, frame=each), str(path), non_finite) for each in numbers[:2])
            return Pair(left, right)
    whole = picture_of(values_of(path, data, notify), str(path), non_finite)
    return halves(whole, layout or _stated_layout(path, data), str(path))


def halves(picture: np.ndarray, layout: Layout | None, name: str) -> Pair:
    """Divide a picture into its two views; a middle row or column is dropped if their number is odd.

    Raises: PictureError if there are no halves.
    """
    axis = 0 if layout == "top-bottom" else 1
    half = picture.shape[axis] // 2
    if half == 0:
        raise PictureError(f"{name}: {size_in_words(picture)} pixels have no two halves; give left and right")
    first, second = (picture[:half], picture[-half:]) if axis == 0 else (picture[:, :half], picture[:, -half:])
    left, right = (second, first) if layout == "cross-eyed" else (first, second)
    return Pair(np.ascontiguousarray(left), np.ascontiguousarray(right))


def _stated_layout(path: Path, data: bytes) -> Layout:
    """Return the layout that a .jps file states; by default cross-eyed for .jps, side by side otherwise.

    Source: the descriptor in its APP3 segment, as ExifTool has it: flags, layout and type, a byte each.
    """
    at = data.find(b"_JPSJPS_", 0, 1 << 17)
    if at > 0 and len(data) > at + 14 and data[at + 13] == 1:
        flags, layout = data[at + 11], data[at + 12]
        return "top-bottom" if layout == 3 else "side-by-side" if flags & 4 else "cross-eyed"
    return "cross-eyed" if path.suffix.lower() == ".jps" else "side-by-side"
