"""The areas of a flat drawing: each of one colour, with the blur of their edges, noise and JPEG undone."""
# scikit-image has no types.
# pyright: reportMissingTypeStubs=false, reportUnknownVariableType=false

from itertools import product
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float32, Int32, Int64

from ..runtime.opencv import cv2, plain_opencv
from .ink import eight_bits, noise_level
from .marks import find_marks

# The greatest difference within an area from a pixel to its neighbours, of 255: more than the noise of JPEG.
ALIKE = 9.0
NOISY = 3.5  # the same in standard deviations of the noise that a blur leaves
SAME = 14.0  # the greatest difference of two areas of one colour, of 255
# The side of a square as large as the least area, as a share of the longer side; less is a speck.
MIN_SIDE = 1 / 110
MIN_PX = 9  # the least pixels of an area
# How far a pixel on an edge looks for the areas on both sides of the edge, px; a block of JPEG has 8.
REACHES_PX = (3, 8, 14)
# The difference to an area up to which a thin place is a piece of this area, and no stroke on it, of 255.
NO_STROKE = 40
# Red, green and blue to light and half of its two colour differences: JPEG blurs colours by two pixels, not light.
LIGHT_FIRST = np.array([(0.299, 0.35, -0.15), (0.587, -0.29, -0.29), (0.114, -0.06, 0.44)], np.float32)
PAPER_SHARE = 0.3  # the least share of the picture's rim that paper takes


class Areas(NamedTuple):
    """The areas of a drawing by colour."""

    # The colour of each pixel, by number; strokes count as the area next to them.
    labels: Int32[np.ndarray, "h w"]
    colours: Float32[np.ndarray, "n 3"]  # the palette, 0 to 255
    paper: int | None  # the colour that most of the rim has; None if none has much of it


def find_areas(picture: np.ndarray) -> Areas:
    """Find the areas of one colour, the largest first in the palette."""
    # An edge lies where half of the change is done: each of its pixels is of the area nearby with the colour nearest to
    # its own, and a stroke of the nearest area. Light may change slowly over the picture.
    colours = eight_bits(picture)
    noise, longer = noise_level(colours), max(colours.shape[:2])
    with plain_opencv():
        sigma = 0.8 if noise < 2 else 1.6
        calm = np.asarray(cv2.GaussianBlur(colours, (0, 0), sigma, borderType=cv2.BORDER_REPLICATE))
        window = np.ones((3, 3), np.uint8)
        change = np.asarray(cv2.dilate(calm, window) - cv2.erode(calm, window)).max(axis=2)
        ink = cv2.resize(
            find_marks(picture).ink.mask.astype(np.uint8), colours.shape[1::-1], interpolation=cv2.INTER_NEAREST
        )
        stroke = np.asarray(cv2.dilate(ink, np.ones((5, 5), np.uint8))) > 0
        inside: Bool[np.ndarray, "h w"] = (change <= max(ALIKE, NOISY * noise / sigma)) & ~stroke
        _, found, about, _ = cv2.connectedComponentsWithStats(np.asarray(inside, np.uint8), connectivity=4)
        large = np.asarray(about, np.int64)[:, cv2.CC_STAT_AREA] >= max(MIN_PX, (MIN_SIDE * longer) ** 2)
    large[0] = False
    pieces = np.asarray(found, np.int32)
    if not large.any():
        return Areas(np.zeros(pieces.shape, np.int32), colours.reshape(-1, 3).mean(axis=0, keepdims=True), None)
    pieces = np.where(large[pieces], pieces, 0)
    of_piece, palette = _palette(pieces, calm, max(SAME, 2 * noise))
    labels = _divide_edges(of_piece[pieces], calm, colours if noise < 2 else calm, stroke)
    rim = np.concatenate([labels[0], labels[-1], labels[:, 0], labels[:, -1]])
    count = np.bincount(rim, minlength=len(palette))
    paper = int(count.argmax()) if count.max() >= PAPER_SHARE * rim.size else None
    return Areas(labels, palette, paper)


def _palette(
    pieces: Int32[np.ndarray, "h w"], calm: np.ndarray, same: float
) -> tuple[Int32[np.ndarray, "n"], Float32[np.ndarray, "m 3"]]:
    """Return the number of each piece's colour, -1 for none, and the colours; the largest pieces decide."""
    flat, count = pieces.reshape(-1), int(pieces.max()) + 1
    size = np.bincount(flat, minlength=count)
    size[0] = 0
    means = (
        np.stack([np.bincount(flat, channel, count) for channel in calm.reshape(-1, 3).T], axis=1)
        / np.maximum(size, 1)[:, None]
    )
    numbers, palette = np.full(count, -1, np.int32), list[np.ndarray]()
    for piece in np.argsort(-size, kind="stable")[: np.count_nonzero(size)].tolist():
        away = [float(np.abs(means[piece] - colour).max()) for colour in palette]
        if not away or min(away) > same:
            numbers[piece] = len(palette)
            palette.append(means[piece])
        else:
            numbers[piece] = int(np.argmin(away))
    return numbers, np.array(palette, np.float32)


def _divide_edges(
    inside: Int32[np.ndarray, "h w"], calm: np.ndarray, colours: np.ndarray, stroke: Bool[np.ndarray, "h w"]
) -> Int32[np.ndarray, "h w"]:
    """Give each pixel of an edge the area nearby that is nearest in colour, and of a stroke the nearest one."""
    # A thin piece in the colour of an area nearby, such as a corner, is no stroke. `inside` is -1 outside of areas.
    inside_mask = inside >= 0
    source = nearest(inside_mask)[1]
    labels = inside.reshape(-1)[source]
    rows, columns = np.nonzero(~inside_mask)
    own, shades = colours[rows, columns].astype(np.float32), calm.reshape(-1, 3)
    best, least = labels[rows, columns], np.full(rows.size, np.inf, np.float32)
    for reach, down, right in product(REACHES_PX, (-1, 0, 1), (-1, 0, 1)):
        there = source[
            np.clip(rows + reach * down, 0, labels.shape[0] - 1),
            np.clip(columns + reach * right, 0, labels.shape[1] - 1),
        ]
        away = np.abs(np.einsum("ij,jk->ik", own - shades[there], LIGHT_FIRST)).sum(axis=1)
        best = np.where(away < least, inside.reshape(-1)[there], best)
        least = np.minimum(away, least)
    sure = ~stroke[rows, columns] | (least < NO_STROKE)
    labels[rows[sure], columns[sure]] = best[sure]
    if labels.max() <= 255:
        with plain_opencv():
            smooth = np.asarray(
                cv2.medianBlur(labels.astype(np.uint8), 5), np.int32
            )  # at a border of two, the majority
        labels = np.where(inside_mask, labels, smooth)
    return _without_specks(labels)


def nearest(mask: Bool[np.ndarray, "h w"]) -> tuple[Float32[np.ndarray, "h w"], Int64[np.ndarray, "h w"]]:
    """Return each pixel's distance to the nearest one of a mask, to 2 %, and the place of that in the flat picture."""
    with plain_opencv():
        far, label = cv2.distanceTransformWithLabels(
            (~mask).view(np.uint8), cv2.DIST_L2, cv2.DIST_MASK_5, labelType=cv2.DIST_LABEL_PIXEL
        )
    labels = np.asarray(label, np.int32)
    at = np.zeros(int(labels.max()) + 1, np.int64)
    at[labels[mask]] = np.flatnonzero(mask)
    return np.asarray(far, np.float32), at[labels]


def _without_specks(labels: Int32[np.ndarray, "h w"]) -> Int32[np.ndarray, "h w"]:
    """Give connected pixels of one label that are too few for an area to the pieces next to them."""
    # Where three areas meet, the blur of their edges may look like a fourth.
    from skimage.measure import label

    pieces = np.asarray(label(labels, background=-1, connectivity=1), np.int64)
    large = (np.bincount(pieces.reshape(-1)) >= MIN_PX)[pieces]
    return labels if large.all() or not large.any() else labels.reshape(-1)[nearest(large)[1]]
