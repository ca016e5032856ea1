"""The places of texts: rows of small pieces of ink that are shaped like letters."""
# scipy has no types.
# pyright: reportMissingTypeStubs=false, reportUnknownVariableType=false, reportUnknownMemberType=false

from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float64, Int32

from ..runtime.opencv import plain_opencv
from .ink import Ink

LETTER_PX, LETTER = 5, 1 / 14
"""The least height of a letter, px, and the greatest, as a share of the longer side."""
LONG = 9.0
"""The greatest width of a piece of a row, by its height: letters may touch."""
APART = 1.2
"""The greatest distance from a letter to the next, by the height of the higher one."""
TALLER = 2.4
"""The greatest ratio of the heights of two letters next to each other."""
SOLID = 0.8
"""The share of its own rectangle from which on a piece is a dash or a dot, and may only stand among letters."""
HOLLOW = 0.4
"""The least share of pieces of a row that are letters, and neither dashes nor dots."""
MAX_PIECES = 12_000
"""The most pieces that are looked at: more are a texture."""


class Text(NamedTuple):
    """The place of a row of letters, as shares of the picture's width and height."""

    left: float
    top: float
    right: float
    bottom: float
    letters: int
    """The number of its pieces."""


class Texts(NamedTuple):
    """Texts and their ink."""

    boxes: tuple[Text, ...]
    ink: Bool[np.ndarray, "r c"]
    """True on letters, on the grid of the ink."""


def find_texts(ink: Ink) -> Texts:
    """Find rows of letters in ink: pieces of like height next to each other, most of them neither dash nor dot.

    Rows may be tilted by some degrees. A single letter is not told from a mark.
    """
    import cv2
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    with plain_opencv():
        count, pieces, about, _ = cv2.connectedComponentsWithStats(ink.mask.astype(np.uint8), connectivity=8)
    pieces, boxes = np.asarray(pieces, np.int32), np.asarray(about, np.int64)
    left, top, wide, high = boxes[:, :4].T
    large = LETTER * max(pieces.shape)
    small = (high >= LETTER_PX) & (high <= large) & (wide <= LONG * high) & (wide >= 1) & (wide <= 6 * large)
    dots = (high < LETTER_PX) & (wide <= large)
    small[0] = dots[0] = False
    chosen = np.flatnonzero(small)
    none = Texts((), np.zeros(pieces.shape, np.bool_))
    if not 1 < chosen.size <= MAX_PIECES:
        return none
    one, other = _neighbours(left[chosen], top[chosen], wide[chosen], high[chosen])
    graph = coo_array((np.ones(one.size), (one, other)), (chosen.size, chosen.size))
    row = np.asarray(connected_components(graph, directed=False)[1], np.int64)
    letters = np.bincount(row)
    hollow = np.bincount(row, _solidity(pieces, count)[chosen] < SOLID) / letters
    is_text = (letters > 1) & (hollow >= HOLLOW)
    if not is_text.any():
        return none
    rows, columns = pieces.shape
    found = list[Text]()
    on = np.zeros(count, np.bool_)
    on[chosen[is_text[row]]] = True
    for each in np.flatnonzero(is_text):
        of = chosen[row == each]
        box = [int(edge.min()) for edge in (left[of], top[of])] + [
            int(edge.max()) for edge in ((left + wide)[of], (top + high)[of])
        ]
        inside = (left >= box[0] - high[of].max() / 4) & (left + wide <= box[2] + high[of].max() / 4)
        on |= dots & inside & (top >= box[1] - high[of].max() / 2) & (top <= box[3] + high[of].max() / 4)
        found.append(Text(box[0] / columns, box[1] / rows, box[2] / columns, box[3] / rows, int(letters[each])))
    return Texts(tuple(found), on[pieces])


def _neighbours(left: np.ndarray, top: np.ndarray, wide: np.ndarray, high: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the pairs of pieces that stand next to each other in a row."""
    order: np.ndarray = np.argsort(left)
    pairs = list[tuple[np.ndarray, np.ndarray]]()
    reach = left + wide + APART * high.max()
    ends = np.searchsorted(left[order], reach[order], side="right")
    for place in range(order.size):
        here, there = order[place], order[place + 1 : ends[place]]
        higher, lower = np.maximum(high[here], high[there]), np.minimum(high[here], high[there])
        overlap = np.minimum(top[here] + high[here], top[there] + high[there]) - np.maximum(top[here], top[there])
        near = (left[there] - left[here] - wide[here] <= APART * higher) & (overlap >= lower / 2)
        there = there[near & (higher <= TALLER * lower)]
        pairs.append((np.full(there.size, here), there))
    return np.concatenate([one for one, _ in pairs]), np.concatenate([other for _, other in pairs])


def _solidity(pieces: Int32[np.ndarray, "r c"], count: int) -> Float64[np.ndarray, "n"]:
    """Return the share of the area of a rectangle of the same second moments that each piece fills, about 1 for one."""
    y, x = np.nonzero(pieces)
    of = pieces[y, x]
    size = np.maximum(np.bincount(of, minlength=count), 1)
    mean_x, mean_y = (np.bincount(of, each, count) / size for each in (x, y))
    xx, xy, yy = (
        np.bincount(of, one * other, count) / size - first * second
        for one, other, first, second in ((x, x, mean_x, mean_x), (x, y, mean_x, mean_y), (y, y, mean_y, mean_y))
    )
    spread = np.sqrt(np.maximum((xx + 1 / 12) * (yy + 1 / 12) - xy * xy, 1e-9))
    return size / (12 * spread)
