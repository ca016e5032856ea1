"""Matching costs: census codes, compared by their Hamming distance, and the penalties of disparity changes."""

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import cv2
import numpy as np
from jaxtyping import UInt8

from tangible_core.compiled import KERNEL, in_blocks, njit

from ..dense.speckles import Specks

RADIUS = 2
PLANES = 3
BITS = 8 * PLANES
# Columns of a block: rows are padded to whole blocks, so that vector code needs no remainder loop.
BLOCK = 64
OFFSETS = np.array([(dy, dx) for dy in range(5) for dx in range(5) if (dy, dx) != (RADIUS, RADIUS)])


def census(grey: UInt8[np.ndarray, "h w"]) -> UInt8[np.ndarray, "h 3 whole"]:
    """Compute codes of the 5 x 5 window, one plane per byte, in whole blocks; exposure, gain and gamma may differ."""
    # Source: Zabih & Woodfill, Non-parametric local transforms, ECCV 1994. The picture's edge is repeated outwards.
    return _encode([grey])


def two_scale_census(
    grey: UInt8[np.ndarray, "h w"], fine_px: float, coarse_px: float
) -> UInt8[np.ndarray, "h 6 whole"]:
    """Compute codes of 48 bits, the census at two Gaussian blurs: coarse ones resist noise, fine ones keep edges."""
    return _encode([cv2.GaussianBlur(grey, (0, 0), sigma) for sigma in (fine_px, coarse_px)])


def census_with_levels(grey: UInt8[np.ndarray, "h w"]) -> UInt8[np.ndarray, "h 4 whole"]:
    """Compute the census, and one more plane of halved grey values."""
    return _encode([grey], levels=True)


def _encode(greys: Sequence[np.ndarray], levels: bool = False) -> UInt8[np.ndarray, "h planes whole"]:
    """Encode several pictures of one size into consecutive planes; levels: one more plane of the first one's levels."""
    h, w = greys[0].shape
    codes = np.empty((h, PLANES * len(greys) + levels, w + -w % BLOCK), np.uint8)
    around = RADIUS, RADIUS, RADIUS, RADIUS + -w % BLOCK
    frames = [cv2.copyMakeBorder(grey, *around, cv2.BORDER_REPLICATE) for grey in greys]

    def block(y0: int, y1: int) -> None:
        for i, frame in enumerate(frames):
            code_rows(frame, OFFSETS, PLANES * i, y0, y1, codes)
        if levels:
            np.right_shift(greys[0][y0:y1], 1, out=codes[y0:y1, -1, :w])

    in_blocks(h, block)
    return codes


@njit(**KERNEL)
def code_rows(frame, offsets, first_plane, y0, y1, codes):
    """Encode rows y0..y1-1, one neighbour after the other along a whole row, so that each inner loop vectorises."""
    w = codes.shape[2]
    for y in range(y0, y1):
        centre = frame[y + RADIUS, RADIUS : RADIUS + w]
        for i in range(BITS):
            plane = codes[y, first_plane + (i >> 3)]
            dy, dx = offsets[i]
            neighbour = frame[y + dy, dx : dx + w]
            bit = np.uint8(1 << (i & 7))
            if bit == 1:
                for x in range(w):
                    plane[x] = 0
            for x in range(w):
                plane[x] |= bit if neighbour[x] < centre[x] else np.uint8(0)


class Penalties(NamedTuple):
    """The penalties of a path, in differing bits."""

    p1: np.uint8
    neutral: np.uint8  # cost of a disparity that leads out of the right view, where nothing can be compared
    # Penalty of any other change, by the grey step there: depth edges coincide with edges of the picture.
    p2_by_step: UInt8[np.ndarray, "256"]


class Cost(NamedTuple):
    """A way to compare two pictures."""

    name: str
    bits: int
    codes: Callable[[UInt8[np.ndarray, "h w"]], Any]
    penalties: Penalties
    # Largest value that the difference of two grey levels counts; 0 for codes without levels.
    most_level: int = 0
    specks: Specks = Specks()


def p2_by_grey_step(flat: int, edge: int, slope: float) -> UInt8[np.ndarray, "256"]:
    """Return P2 by grey step: `flat` at 0, `slope` bits less per grey level, `edge` at least."""
    return np.clip(flat - slope * np.arange(256), edge, flat).astype(np.uint8)


# Census of the original picture: the most precise on clean pictures.
SHARP = Cost("sharp", BITS, census, Penalties(np.uint8(10), np.uint8(8), p2_by_grey_step(50, 12, 1.5)))
MAX_LEVEL = 4  # largest value that the difference of two halved grey levels counts, in bits
# Census and grey levels: more precise still, if both views have the same exposure.
LEVELS = Cost(
    "levels",
    BITS + MAX_LEVEL,
    census_with_levels,
    Penalties(np.uint8(10), np.uint8(9), p2_by_grey_step(40, 12, 2.0)),
    MAX_LEVEL,
)
NOISY = Specks(among_many_px=30, alone_px=200)
LIGHT = Cost(
    "light",
    2 * BITS,
    lambda z: two_scale_census(z, 0.5, 1.5),
    Penalties(np.uint8(18), np.uint8(16), p2_by_grey_step(110, 28, 2.0)),
    specks=NOISY,
)
HEAVY = Cost(
    "heavy",
    2 * BITS,
    lambda z: two_scale_census(z, 0.7, 2.0),
    Penalties(np.uint8(22), np.uint8(16), p2_by_grey_step(120, 40, 2.0)),
    specks=NOISY,
)
COSTS = {cost.name: cost for cost in (SHARP, LEVELS, LIGHT, HEAVY)}
