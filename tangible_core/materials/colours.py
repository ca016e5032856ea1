"""The eleven basic colour names of English, by hue, chroma and lightness, for segments of a picture."""

from functools import cache
from typing import Literal, get_args

import numpy as np
from jaxtyping import Float, UInt8

from ..data import PartMap, SegmentMap
from ..data.pictures import to_rgb8
from ..runtime.opencv import plain_opencv

Colour = Literal["black", "grey", "white", "red", "orange", "brown", "yellow", "green", "blue", "purple", "pink"]
COLOURS: tuple[Colour, ...] = get_args(Colour)

GREY_CHROMA, BLACK_L, WHITE_L = 10.0, 20.0, 85.0
"""Bounds in CIELAB (D65): duller colours are grey; darker greys are black and lighter ones white."""
HUES: tuple[tuple[float, Colour], ...] = (
    (20, "pink"), (48, "red"), (85, "orange"), (118, "yellow"), (195, "green"), (308, "blue"), (335, "purple"),
    (360, "pink"),
)  # fmt: skip
"""The upper angle of each name, in degrees of CIELAB's hue. The borders lie between the answers of the XKCD colour
survey (2010); every plain, light, pale, bright, dull, dusty and dark answer keeps its name."""
BROWN_CHROMA = 52.0
"""Chroma below which orange is called brown."""
_BITS = 5  # of each channel, by which colours are looked up


def segment_colours(segments: SegmentMap | PartMap, picture: np.ndarray) -> list[tuple[Colour, float]]:
    """Return, for each segment or part, the most frequent name and its share; the first in COLOURS of two.

    The picture has the segments' size. Raises: PictureError if it is not a picture.
    """
    red, green, blue = np.moveaxis(to_rgb8(picture) >> (8 - _BITS), -1, 0).astype(np.uint16)
    names = _names()[(red << 2 * _BITS) | (green << _BITS) | blue]
    pairs = segments.labels.astype(np.intp) * len(COLOURS) + names
    counts = np.bincount(pairs.ravel(), minlength=segments.count * len(COLOURS)).reshape(-1, len(COLOURS))
    best = counts.argmax(axis=1)
    shares = counts[np.arange(len(counts)), best] / np.maximum(counts.sum(axis=1), 1)
    return [(COLOURS[name], float(share)) for name, share in zip(best, shares, strict=True)]


def colour_names(lab: Float[np.ndarray, "n 3"]) -> UInt8[np.ndarray, " n"]:
    """Name colours in CIELAB, by their indices in COLOURS.

    >>> [COLOURS[name] for name in colour_names(np.array([[32.3, 79.2, -107.9], [40.0, 15.0, 30.0]]))]
    ['blue', 'brown']
    """
    lightness, a, b = lab.T
    chroma, hue = np.hypot(a, b), np.degrees(np.arctan2(b, a)) % 360
    ends, by_hue = zip(*HUES, strict=True)
    names = np.array([COLOURS.index(name) for name in by_hue], np.uint8)[np.searchsorted(ends, hue)]
    names[(names == COLOURS.index("orange")) & (chroma < BROWN_CHROMA)] = COLOURS.index("brown")
    dull = chroma < GREY_CHROMA
    names[dull] = COLOURS.index("grey")
    names[dull & (lightness < BLACK_L)] = COLOURS.index("black")
    names[dull & (lightness > WHITE_L)] = COLOURS.index("white")
    return names


@cache
def _names() -> UInt8[np.ndarray, " n"]:
    """Return the name of each cell of the RGB cube, from its middle."""
    import cv2

    steps = (np.arange(1 << _BITS, dtype=np.float32) + 0.5) / (1 << _BITS)
    cube = np.stack(np.meshgrid(steps, steps, steps, indexing="ij"), axis=-1).reshape(1, -1, 3)
    with plain_opencv():
        return colour_names(cv2.cvtColor(cube, cv2.COLOR_RGB2LAB)[0])
