"""Tips: corners of areas that are too sharp for the disc by which areas are told from strokes."""

from itertools import product

import numpy as np
from jaxtyping import Bool, UInt8

from ..runtime.opencv import cv2, plain_opencv

# The least length of a stroke by its width, and as a share of the longer side. The width of a corner of 20 degrees
# doubles over 2.4 times the width, that of a stroke nowhere.
LONG, MIN_LONG = 5.0, 1 / 60
THIN_PX = 3.0  # the width below which two widths count as equal, px, as pixels are coarse
AHEAD_PX = 2  # the distance at which a tip is compared with the area on which it hangs, px
ALIKE = 0.2  # the greatest difference between the two, as a share of what the tip is darker than its ground


def find_tips(
    mask: Bool[np.ndarray, "r c"],
    colours: UInt8[np.ndarray, "r c 3"],
    ground: UInt8[np.ndarray, "r c 3"],
    widest_px: int,
) -> Bool[np.ndarray, "r c"]:
    """Return the ink that hangs on an area of its own colour and keeps no width, to a factor of two, along a length.

    mask: true on ink. widest_px: the width beyond which a stroke is an area.
    """
    with plain_opencv():
        rest = (mask & ~_strokes(mask, widest_px)).astype(np.uint8)
        pieces = np.asarray(cv2.connectedComponents(rest, connectivity=8)[1], np.int32)
    rows, columns = np.nonzero(pieces)
    own, hanging = colours[rows, columns].astype(np.int16), np.zeros(rows.size, np.bool_)
    alike = ALIKE * (ground[rows, columns] - own).max(axis=1)
    for down, right in product((-AHEAD_PX, 0, AHEAD_PX), repeat=2):
        at = np.clip(rows + down, 0, mask.shape[0] - 1), np.clip(columns + right, 0, mask.shape[1] - 1)
        hanging |= ~mask[at] & (np.abs(own - colours[at]).max(axis=1) < alike)
    # A tip is as wide as the disc where it begins, and a row of pixels there is two deep.
    return (np.bincount(pieces[rows, columns], hanging, int(pieces.max()) + 1) >= widest_px)[pieces]


def _strokes(mask: Bool[np.ndarray, "r c"], widest_px: int) -> Bool[np.ndarray, "r c"]:
    """Return the ink that keeps its width, to a factor of two, along a length."""

    def opened(radius_px: float) -> Bool[np.ndarray, "r c"]:
        core = inside >= radius_px
        around = cv2.distanceTransform((~core).astype(np.uint8), cv2.DIST_L2, 5) if core.any() else radius_px
        return mask & (np.asarray(around) < radius_px)

    inside = np.asarray(cv2.distanceTransform(np.pad(mask, 1).astype(np.uint8), cv2.DIST_L2, 5), np.float32)[1:-1, 1:-1]
    steps = int(2 * np.log2(max(1, widest_px / THIN_PX))) + 2
    widths = [THIN_PX * 2 ** (step / 2) for step in range(steps)]
    wider = [mask, mask, *(opened((width + 1) / 2) for width in widths)]
    strokes = np.zeros(mask.shape, np.bool_)
    for narrow, wide, width in zip(wider, wider[2:], widths, strict=False):
        strokes |= long_pieces(narrow & ~wide, LONG * width)
    return strokes


def long_pieces(mask: Bool[np.ndarray, "r c"], least_px: float = 0) -> Bool[np.ndarray, "r c"]:
    """Return the connected pieces that are as long as a stroke and as this, by the diagonals of their boxes."""
    _, pieces, about, _ = cv2.connectedComponentsWithStats(mask.astype(np.uint8), connectivity=8)
    sides = np.asarray(about, np.float64)[:, [cv2.CC_STAT_WIDTH, cv2.CC_STAT_HEIGHT]]
    long = np.hypot(sides[:, 0], sides[:, 1]) >= max(MIN_LONG * max(mask.shape), least_px)
    long[0] = False
    return long[np.asarray(pieces, np.int32)]
