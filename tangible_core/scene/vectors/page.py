"""A page of vectors, whichever format it has."""

from dataclasses import replace
from typing import NamedTuple

import numpy as np
from jaxtyping import Int32, UInt8

from ...data import PictureText
from ...drawing import PictureKind

Box = tuple[float, float, float, float]
SIDE_PX = 2000  # the longer side of a page as a picture, px: a tenth of a millimetre on A4


class VectorPage(NamedTuple):
    """A picture in vectors, and its shapes, names and texts."""

    picture: UInt8[np.ndarray, "h w 3"]  # the page on white, without its texts
    # The shape of each pixel, 0 for the ground; None where they are not known.
    labels: Int32[np.ndarray, "h w"] | None = None
    names: tuple[str, ...] = ()  # the name of each shape by its label, "" without one
    texts: tuple[PictureText, ...] = ()
    title: str = ""
    kind: PictureKind | None = None  # the kind of the picture; None to measure it


def rank_labels(labels: Int32[np.ndarray, "h w"]) -> tuple[tuple[int, ...], Int32[np.ndarray, "h w"]]:
    """Return the labels that are there, in order, and the rank of each pixel's label among them."""
    there = np.bincount(labels.reshape(-1)) > 0
    return tuple(map(int, np.flatnonzero(there))), (np.cumsum(there, dtype=np.int32) - 1)[labels]


def turn_box(left: float, top: float, right: float, bottom: float, clockwise_deg: int) -> Box:
    """Return a box, by shares, in a picture that is turned by quarters."""
    for _ in range(clockwise_deg // 90):
        left, top, right, bottom = 1 - bottom, left, 1 - top, right
    return float(left), float(top), float(right), float(bottom)


def frame_texts(
    texts: tuple[PictureText, ...], shape: tuple[int, ...], crop: tuple[int, int, int, int] | None, clockwise_deg: int
) -> tuple[PictureText, ...]:
    """Return the texts in the frame of a picture of (h, w) that is cropped and then turned; others are left out."""
    rows, columns = shape[:2]
    x, y, width, height = crop or (0, 0, columns, rows)
    framed = list[PictureText]()
    for text in texts:
        corners = np.reshape(text.box, (2, 2)) * (columns, rows)
        (left, top), (right, bottom) = (corners - (x, y)) / (width, height)
        if not (0 <= (left + right) / 2 <= 1 and 0 <= (top + bottom) / 2 <= 1):
            continue
        box = turn_box(left, top, right, bottom, clockwise_deg)
        framed.append(replace(text, box=box, direction_deg=(text.direction_deg - clockwise_deg) % 360))
    return tuple(framed)
