"""The ink of a picture: what is thin and darker than the ground around it, also on paper in a shadow."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float32, UInt8

from ..data.pictures import to_rgb8
from ..runtime.opencv import cv2, plain_opencv
from .tips import find_tips

MAX_SIDE = 1600  # the most pixels of a side at which ink is looked for
# The greatest width of a stroke, as a share of the longer side; what is wider is an area.
WIDEST = 1 / 55
LEAST = 0.1  # the least darkness of ink, as a share of the light of its ground
NOISY = 4.0  # the darkness that noise alone has beneath a closing, in standard deviations of the noise
# The darkness of ink that takes all the light of one colour, and hardly any brightness; JPEG makes such at edges.
COLOUR = 0.6
HALF = 0.5  # the darkness at the edge of a stroke, as a share of the darkest ink around
# The least darkness of ink by the ringing of a picture: JPEG darkens beside edges, less than ink does.
RINGING = 0.023
# The least sum over a piece of what is darker than that, by the greatest width of a stroke: ripples are short.
MIN_BEYOND = 0.1
EDGE = 30  # the least step between two pixels that is an edge, of 255
# The light below which a ground counts as this light, of 255: darker, noise would be taken for ink.
DARKEST = 40


class Ink(NamedTuple):
    """The ink of a picture, on a picture reduced to MAX_SIDE."""

    mask: Bool[np.ndarray, "r c"]  # true on strokes; areas are left out
    darkness: Float32[np.ndarray, "r c"]  # the share of the ground's light that is missing, 0 to 1
    ground: UInt8[np.ndarray, "r c 3"]  # the colours without the strokes; the others of an inverted picture
    widest_px: int  # the width beyond which a stroke is an area, px
    inverted: bool  # true where ink is lighter than its ground


def eight_bits(picture: np.ndarray) -> UInt8[np.ndarray, "h w 3"]:
    """Return the colours of a picture in three channels of 8 bits, transparency over white; NaN is black."""
    return np.ascontiguousarray(to_rgb8(np.nan_to_num(picture)))


def reduce_to_side(colours: UInt8[np.ndarray, "h w 3"], side: int) -> UInt8[np.ndarray, "r c 3"]:
    """Return the picture with no side longer than this, each pixel a mean over its area."""
    factor = max(colours.shape[:2]) / side
    if factor <= 1:
        return colours
    rows, columns = (max(1, round(side / factor)) for side in colours.shape[:2])
    with plain_opencv():
        return np.asarray(cv2.resize(colours, (columns, rows), interpolation=cv2.INTER_AREA), np.uint8)


def find_ink(picture: np.ndarray, *, every: bool = False) -> Ink:
    """Find strokes: what a closing by a disc of the greatest width fills, by more than noise.

    every: True to keep tips of areas and the ripples of JPEG beside edges too, as photographs have both by themselves.
    """
    # A closing takes the ground from its lightest neighbours in each channel: shadows and coloured areas are grounds.
    # A line between two colours is darker than both of them, but not always in each channel.
    colours = reduce_to_side(eight_bits(picture), MAX_SIDE)
    inverted = bool(np.median(colours.max(axis=2)) < 96)
    if inverted:
        colours = 255 - colours
    widest = max(3, round(WIDEST * max(colours.shape[:2])) | 1)
    noise = noise_level(colours)
    disc = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (widest, widest))

    def close(of: np.ndarray) -> UInt8[np.ndarray, "..."]:
        return np.asarray(cv2.morphologyEx(of, cv2.MORPH_CLOSE, disc, borderType=cv2.BORDER_REPLICATE), np.uint8)

    with plain_opencv():
        calm = np.asarray(cv2.GaussianBlur(colours, (0, 0), 0.6, borderType=cv2.BORDER_REPLICATE))
        ground, bright = close(calm), _brightness(calm)
        grey = _missing(_brightness(ground), bright, NOISY * noise / 2)
        if not every:
            grey = np.maximum(grey, _missing(close(bright), bright, NOISY * noise / 2))
        darkness = np.maximum(grey, COLOUR * _greatest(_missing(ground, calm, NOISY * noise)))
        contrast = np.asarray(cv2.dilate(darkness, disc))
        mask = (darkness > HALF * contrast) & (contrast > LEAST)
        if not every:
            mask &= ~find_tips(mask, calm, ground, widest)
            if (ringing := _ringing(colours, ground)) >= 1:
                lost = _greatest(np.subtract(ground, calm, dtype=np.float32)) / 255
                pieces = np.asarray(cv2.connectedComponents(mask.astype(np.uint8), connectivity=8)[1], np.int32)
                beyond = np.maximum(grey, HALF * lost) - RINGING * ringing
                mask &= (np.bincount(pieces.reshape(-1), beyond.reshape(-1)) >= MIN_BEYOND * widest)[pieces]
    return Ink(mask, darkness, ground, widest, inverted)


def _greatest(colours: np.ndarray) -> np.ndarray:
    """Return the greatest of three channels; numpy's `max` over so short an axis takes four times as long."""
    return np.maximum(np.maximum(colours[..., 0], colours[..., 1]), colours[..., 2])


def _missing(ground: np.ndarray, calm: np.ndarray, noise: float) -> Float32[np.ndarray, "..."]:
    """Return the share of the ground's light that is missing, beyond noise."""
    lost = np.maximum(np.subtract(ground, calm, dtype=np.float32) - np.float32(noise), 0)
    return lost / np.maximum(ground, DARKEST).astype(np.float32)


def _ringing(colours: UInt8[np.ndarray, "r c 3"], ground: UInt8[np.ndarray, "r c 3"]) -> float:
    """Return by how much the range of 3 x 3 pixels beside edges exceeds that away from them, of 255; medians."""

    # Only JPEG has ripples some pixels away from an edge, up to the end of a block, on areas that are flat elsewhere.
    def near(mask: np.ndarray, side: int) -> Bool[np.ndarray, "r c"]:
        return np.asarray(cv2.dilate(mask.astype(np.uint8), np.ones((side, side), np.uint8))) > 0

    def spread(of: np.ndarray) -> UInt8[np.ndarray, "r c"]:
        return _greatest(np.asarray(cv2.morphologyEx(of, cv2.MORPH_GRADIENT, np.ones((3, 3), np.uint8)), np.uint8))

    edge, ripples = spread(ground) > EDGE, spread(colours)
    beside, away = near(edge, 13) & ~near(edge, 5), ~near(edge, 41)
    return float(np.median(ripples[beside]) - np.median(ripples[away])) if beside.any() and away.any() else 0.0


def _brightness(colours: UInt8[np.ndarray, "r c 3"]) -> UInt8[np.ndarray, "r c"]:
    return np.asarray(cv2.cvtColor(colours, cv2.COLOR_RGB2GRAY), np.uint8)


def noise_level(colours: UInt8[np.ndarray, "h w 3"]) -> float:
    """Return the standard deviation of the noise in flat areas, of 255: the median of small differences."""
    # Immerkaer, Fast noise variance estimation, CVIU 64, 1996: its mask, with a median in place of the mean.
    mask = np.array([[1, -2, 1], [-2, 4, -2], [1, -2, 1]], np.float32)
    with plain_opencv():
        change = np.asarray(cv2.filter2D(colours[..., 1].astype(np.float32), -1, mask))
    return float(np.median(np.abs(change))) / (6 * 0.6745)
