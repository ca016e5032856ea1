"""Variants of one picture: every type, memory layout and range of values that methods must accept."""

from collections.abc import Iterator

import numpy as np

from ..data.pictures import to_grey

TINY = ((1, 1), (1, 9), (9, 1), (2, 2), (17, 9))
"""Sizes (h, w) at which windows, pyramids and neighbours run out."""


def exact_variants(picture: np.ndarray) -> Iterator[tuple[str, np.ndarray]]:
    """Yield the uint8 (h, w, 3) picture without loss in other types and memory layouts, with their names."""
    yield "uint16", picture.astype(np.uint16) * 257
    yield "float32", np.asarray(picture / 255, np.float32)
    yield "float64", picture / 255
    yield "opaque RGBA", np.dstack([picture, np.full(picture.shape[:2], 255, np.uint8)])
    yield "Fortran order", np.asfortranarray(picture)
    yield "a view with negative strides", np.ascontiguousarray(picture[::-1, ::-1])[::-1, ::-1]


def coarse_variants(picture: np.ndarray) -> Iterator[tuple[str, np.ndarray]]:
    """Yield the uint8 (h, w, 3) picture with less information, or with unusual but finite values, with names."""
    yield "grey", np.rint(to_grey(picture) * 255).astype(np.uint8)
    yield "bool", picture > 127
    yield "float16", np.asarray(picture / 255, np.float16)
    yield "floats over 1", picture.astype(np.float32)
    yield "negative floats", picture / -255
    yield "huge floats", picture * 1e300
