"""The places of texts: rows of small pieces of ink that are shaped like letters."""
# scipy has no types.
# pyright: reportMissingTypeStubs=false, reportUnknownVariableType=false, reportUnknownMemberType=false

from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float64, Int32

from ..runtime.opencv import cv2, plain_opencv
from .ink import Ink

# The least height of a letter, px, and the greatest, as a share of the longer side.
LETTER_PX, LETTER = 5, 1 / 14
LONG = 9.0  # the greatest width of a piece of a row, by its height: letters may touch
APART = 1.2  # the greatest distance from a letter to the next, by the height of the higher one
TALLER = 2.4  # the greatest ratio of the heights of two letters next to each other
MAX_PIECES = 12_000  # the most pieces that are looked at: more are a texture


CONSTANTS: tuple[float, float] = (-1.68, -0.55)
MEASURES: Float64[np.ndarray, "measures 4"] = np.array([
    (0.51, 1.17, 1.35, -0.13),
    (0.81, 0.19, -4.60, -1.20),
    (-0.61, 0.46, 1.56, -0.49),
    (-1.07, 0.42, -1.50, 0.26),
    (2.60, 1.19, -1.52, -1.30),
    (0.26, 0.10, 2.66, -0.14),
    (1.13, 0.25, -0.06, 0.15),
    (1.45, 0.77, 2.69, -0.56),
])  # fmt: skip
"""The constants of a score that is above 0 for text, for a row of one piece and of more; and for each measure of
`_measure_rows` its mean and spread, and the weights of its deviation and of the square of that."""
# The darkness from which on ink is as dark as letters are; bold ones are darker.
DARK = 0.35
FAR = 4.0  # the greatest deviation of a measure that counts, in spreads
# The least width of a row by its height whose direction is that of its ink; a shorter one counts as level.
TILTED = 3.0
UPWARD = 3  # the least number of letters in a row that runs upwards
LEVEL = 6  # the number of letters from which on a level row cannot be letters of several that run upwards
APART_UPWARD = 1.8  # APART for those: a title has several words
EVEN = 0.12  # the greatest deviation of heights, as a share of their mean, of numbers above each other


class Text(NamedTuple):
    """The place of a row of letters, as shares of the picture's width and height."""

    left: float
    top: float
    right: float
    bottom: float
    letters: int
    """The number of its pieces."""
    direction_deg: float
    """The direction in which it is read, counterclockwise from the picture's right."""


class Texts(NamedTuple):
    """Texts and their ink."""

    boxes: tuple[Text, ...]
    ink: Bool[np.ndarray, "r c"]  # true on letters, on the grid of the ink


def find_texts(ink: Ink, apart: float = APART) -> Texts:
    """Find rows of letters in ink: pieces of like height next to each other, shaped and inked like letters."""
    # Rows may be tilted by some degrees, letters of a word may touch, and a letter may stand alone.
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    with plain_opencv():
        count, pieces, about, _ = cv2.connectedComponentsWithStats(ink.mask.astype(np.uint8), connectivity=8)
    pieces, boxes = np.asarray(pieces, np.int32), np.asarray(about, np.int64)
    left, top, wide, high = boxes[:, :4].T
    large = LETTER * max(pieces.shape)
    small = (high >= LETTER_PX) & (high <= large) & (wide <= LONG * high) & (wide <= 6 * large)
    dots = (high < LETTER_PX) & (wide <= large)
    small[0] = dots[0] = False
    indices = np.flatnonzero(small)
    none = Texts((), np.zeros(pieces.shape, np.bool_))
    if not 0 < indices.size <= MAX_PIECES:
        return none
    one, other = _neighbours(left[indices], top[indices], wide[indices], high[indices], apart)
    graph = coo_array((np.ones(one.size), (one, other)), (indices.size, indices.size))
    row = np.asarray(connected_components(graph, directed=False)[1], np.int64)
    letters, measures = np.bincount(row), _measure_rows(ink, pieces, boxes, indices, row)
    mean, spread, first, second = MEASURES.T
    away = np.clip((measures - mean) / spread, -FAR, FAR)
    scores = np.einsum("rm,m->r", away, first) + np.einsum("rm,m->r", away**2, second)
    is_text = np.where(letters == 1, *CONSTANTS) + scores > 0
    if not is_text.any():
        return none
    rows, columns = pieces.shape
    rows_found = list[Text]()
    on = np.zeros(count, np.bool_)
    for number in np.flatnonzero(is_text):
        of = indices[row == number]
        on[of] = True
        box = [int(edge.min()) for edge in (left[of], top[of])] + [
            int(edge.max()) for edge in ((left + wide)[of], (top + high)[of])
        ]
        inside = (left >= box[0] - high[of].max() / 4) & (left + wide <= box[2] + high[of].max() / 4)
        on |= dots & inside & (top >= box[1] - high[of].max() / 2) & (top <= box[3] + high[of].max() / 4)
        shares = box[0] / columns, box[1] / rows, box[2] / columns, box[3] / rows
        own = on[pieces[box[1] : box[3], box[0] : box[2]]]
        rows_found.append(Text(*shares, int(letters[number]), _direction(own)))
    return Texts(tuple(rows_found), on[pieces])


def add_upward_texts(ink: Ink, level: Texts) -> Texts:
    """Return the texts of ink, with those that run upwards as the titles of axes do; `level` are those found so far."""
    free, words = ink.mask.copy(), np.zeros(ink.mask.shape, np.bool_)
    for text in level.boxes:
        place = _place(text, free)
        if text.letters >= LEVEL:
            free[place] &= ~level.ink[place]
        elif text.letters > 1:
            words[place] = level.ink[place]
    mask, darkness, ground = (np.ascontiguousarray(np.rot90(grid, -1)) for grid in (free, ink.darkness, ink.ground))
    found = find_texts(ink._replace(mask=mask, darkness=darkness, ground=ground), APART_UPWARD)
    upward, letters, letters_found = list[Text](), np.zeros(free.shape, np.bool_), np.rot90(found.ink)
    for text in found.boxes:
        text = text._replace(
            left=text.top, top=1 - text.right, right=text.bottom, bottom=1 - text.left, direction_deg=90
        )
        own = letters_found[place := _place(text, free)]
        is_row = own.any(axis=0).all() and words[place][own].mean() < 0.5 and _is_uneven(own)
        if text.letters >= UPWARD and is_row:
            upward.append(text)
            letters[place] = own
    if not upward:
        return level
    others = find_texts(ink._replace(mask=ink.mask & ~letters))
    return Texts((*others.boxes, *upward), others.ink | letters)


def _is_uneven(own: Bool[np.ndarray, "r c"]) -> bool:
    """Return whether the pieces of ink differ in height; those of numbers above each other do not."""
    with plain_opencv():
        pieces = cv2.connectedComponentsWithStats(own.astype(np.uint8))[2]
    high = np.asarray(pieces, np.float64)[1:, cv2.CC_STAT_HEIGHT]
    return bool(high.std() > EVEN * high.mean())


def _place(text: Text, grid: np.ndarray) -> tuple[slice, slice]:
    left, top, right, bottom = np.rint(np.array(text[:4]) * np.tile(grid.shape[1::-1], 2)).astype(np.int64)
    return slice(top, bottom), slice(left, right)


def _direction(own: Bool[np.ndarray, "r c"]) -> float:
    """Return the direction of the longer axis of ink, degrees; 0 where it is hardly longer."""
    if own.shape[1] < TILTED * own.shape[0]:
        return 0.0
    y, x = np.nonzero(own)
    x, y = x - x.mean(), y - y.mean()
    return float(np.degrees(np.arctan2(-2 * (x * y).sum(), (x * x - y * y).sum())) / 2)


def _neighbours(
    left: np.ndarray, top: np.ndarray, wide: np.ndarray, high: np.ndarray, apart: float = APART
) -> tuple[np.ndarray, np.ndarray]:
    """Return the pairs of pieces that stand next to each other in a row."""
    order: np.ndarray = np.argsort(left)
    pairs = list[tuple[np.ndarray, np.ndarray]]()
    reach = left + wide + apart * high.max()
    ends = np.searchsorted(left[order], reach[order], side="right")
    for place in range(order.size):
        here, there = order[place], order[place + 1 : ends[place]]
        higher, lower = np.maximum(high[here], high[there]), np.minimum(high[here], high[there])
        overlap = np.minimum(top[here] + high[here], top[there] + high[there]) - np.maximum(top[here], top[there])
        near = (left[there] - left[here] - wide[here] <= apart * higher) & (overlap >= lower / 2)
        there = there[near & (higher <= TALLER * lower)]
        pairs.append((np.full(there.size, here), there))
    return np.concatenate([one for one, _ in pairs]), np.concatenate([other for _, other in pairs])


def _measure_rows(
    ink: Ink, pieces: Int32[np.ndarray, "r c"], boxes: np.ndarray, chosen: np.ndarray, row: np.ndarray
) -> Float64[np.ndarray, "rows measures"]:
    """Return what tells rows of letters from marks.

    The logarithm of the number of pieces; means over the ink of its pieces of: the share of a rectangle of the same
    second moments that a piece fills, the width of its stroke by its height, its holes, the step of the ground there,
    its darkness, and the strokes that a column and a row of its pixels cross.
    """
    y, x = np.nonzero(pieces)
    of, count = pieces[y, x], len(boxes)
    size = np.maximum(np.bincount(of, minlength=count), 1)
    wide, high = np.maximum(boxes[:, 2:4], 1).T

    def mean(values: np.ndarray) -> np.ndarray:
        return np.bincount(of, values, count) / size

    mean_x, mean_y = mean(x), mean(y)
    spread_x, spread_y = mean(x * x) - mean_x**2 + 1 / 12, mean(y * y) - mean_y**2 + 1 / 12
    moment = np.maximum(spread_x * spread_y - (mean(x * y) - mean_x * mean_y) ** 2, 1e-9)
    with plain_opencv():
        inside = np.asarray(cv2.distanceTransform(ink.mask.astype(np.uint8), cv2.DIST_L2, 3))
        window = np.ones((7, 7), np.uint8)
        step = np.asarray(cv2.dilate(ink.ground, window) - cv2.erode(ink.ground, window)).max(axis=2)
    begins = [
        np.bincount(after.reshape(-1), ((after > 0) & (before == 0)).reshape(-1), count)
        for after, before in ((pieces[1:], pieces[:-1]), (pieces[:, 1:], pieces[:, :-1]))
    ]
    of_pieces = [
        size / (12 * np.sqrt(moment)),
        4 * mean(inside[y, x]) / high,
        _holes(pieces, count),
        mean(step[y, x]),
        mean(ink.darkness[y, x]),
        begins[0] / wide,
        begins[1] / high / np.maximum(wide / high, 0.3),
    ]
    area = np.bincount(row, size[chosen])
    solid, thick, holes, steps, dark, *crossings = (
        np.bincount(row, values[chosen] * size[chosen]) / area for values in of_pieces
    )
    logarithms = np.log(thick + 0.02), np.log(holes + 0.3), np.log(steps + 4)
    return np.stack([np.log2(np.bincount(row)), solid, *logarithms, np.minimum(dark, DARK), *crossings], axis=1)


def _holes(pieces: Int32[np.ndarray, "r c"], count: int) -> Float64[np.ndarray, "n"]:
    """Return the number of holes in each piece, by squares of four pixels (Gray, IEEE Trans. Computers 20, 1971)."""
    padded = np.pad(pieces, 1)
    corners = np.stack([padded[:-1, :-1], padded[:-1, 1:], padded[1:, :-1], padded[1:, 1:]])
    inked, of = corners > 0, corners.max(axis=0).reshape(-1)
    number = inked.sum(axis=0)
    across = (number == 2) & (inked[0] == inked[3])
    euler = (number == 1).astype(np.int8) - (number == 3) - 2 * across.astype(np.int8)
    return np.maximum(1 - np.bincount(of, euler.reshape(-1), count) / 4, 0)
