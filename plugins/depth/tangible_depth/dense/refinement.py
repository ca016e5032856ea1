"""Completion of raw matches into a dense map: speckle removal, filling, sharpening, enlargement."""

from typing import NamedTuple

import cv2
import numpy as np
from jaxtyping import Float, Float32, Int16, UInt8
from numba import int32, uint16

from tangible_core.compiled import KERNEL, in_blocks, inner, njit
from tangible_core.data import DisparityMap

from ..simd.lane_reductions import total
from ..simd.lanes import Lanes, add, load, maximum, minimum, multiply, splat, subtract
from .confidence import FILLED, FLAT_REACH, GAP_REACH, STEP_REACH, confidence, flat_pixels
from .filling.gaps import Effort, fill_gaps
from .span import UNKNOWN
from .speckles import Specks, remove_specks, slices_with_margin

APART = 16  # largest difference, in sixteenths of a pixel, of disparities that agree
MEDIAN_REACH = 2
NEARBY = 1
VOTERS = 4
STRIDE = 2
JUMP = 24  # smallest depth step of an edge, in sixteenths of a pixel
GREY_REACH = 24  # grey difference, in levels, at which a vote has no weight left
# SIMD lanes for a row of the voting window, at least as many as it has pixels.
LANES = 16
VOTING = np.array([k <= 2 * VOTERS and k % STRIDE == 0 for k in range(LANES)], np.uint16)
ZERO_RANK = np.uint16(32768)  # offset that makes disparities unsigned and keeps their order
# Grey level of pixels beyond the picture: too far from any real one to have a vote.
NO_GREY = 1000


def reconcile(matches: Int16[np.ndarray, "h w"], from_right: Int16[np.ndarray, "h w"]) -> Int16[np.ndarray, "h w"]:
    """Make UNKNOWN, in `matched` itself, what the right view contradicts, and return it with gaps closed from there."""
    out = np.empty_like(matches)
    in_blocks(matches.shape[0], lambda y0, y1: _reconcile(matches[y0:y1], from_right[y0:y1], out[y0:y1]))
    return out


@njit(**KERNEL)
def _reconcile(matches, from_right, out):
    h, w = matches.shape
    # Source: Hirschmueller, IEEE PAMI 30(2), 2008, section 2.4. A pixel of the left view without a match takes the
    # nearest surface that the right view has there.
    for y in range(h):
        for x in range(w):
            out[y, x] = matches[y, x]
        for x in range(w):
            value = from_right[y, x]
            there = x + ((value + 8) >> 4)
            if value != UNKNOWN and 0 <= there < w and matches[y, there] == UNKNOWN:
                out[y, there] = max(out[y, there], value)
        for x in range(w):
            value = matches[y, x]
            there = x - ((value + 8) >> 4)
            if value != UNKNOWN and 0 <= there < w:
                other = from_right[y, there]
                if other != UNKNOWN and abs(other - value) > APART:
                    matches[y, x] = out[y, x] = UNKNOWN


SAME_SURFACE = 16
"""Largest difference, in sixteenths of a pixel, at which neighbours are blended when a map is enlarged."""


class DenseMatches(NamedTuple):
    """A dense map: disparity in sixteenths of a pixel, and its confidence 0..1."""

    disparity: Int16[np.ndarray, "h w"]
    confidence: Float32[np.ndarray, "h w"]


class Cleaning(NamedTuple):
    """Options of `complete`."""

    # Switch for the sharpening of depth edges; a map to be enlarged is sharpened by `enlarge` instead.
    sharpen: bool = True
    specks: Specks = Specks()
    factor: int = 1
    effort: Effort = "balanced"


def _empty(shape: tuple[int, int]) -> DenseMatches:
    return DenseMatches(np.empty(shape, np.int16), np.empty(shape, np.float32))


def complete(
    matches: Int16[np.ndarray, "h w"],
    quality: UInt8[np.ndarray, "h w"],
    by_quality: Float[np.ndarray, "256"],
    grey: UInt8[np.ndarray, "h w"],
    cleaning: Cleaning | None = None,
    from_right: Int16[np.ndarray, "h w"] | None = None,
) -> DenseMatches:
    """Remove speckles (in `matched` itself), fill gaps, sharpen edges, and rate the result (see `confidence`)."""
    cleaning = cleaning or Cleaning()
    remove_specks(matches, cleaning.specks, cleaning.factor)
    reconciled_matches = matches if from_right is None else reconcile(matches, from_right)
    dense = fill_gaps(reconciled_matches, grey, cleaning.effort)
    out = _empty(grey.shape)

    def block(y0: int, y1: int) -> None:
        cut, own = slices_with_margin(y0, y1, 2 * MEDIAN_REACH + VOTERS + max(STEP_REACH, GAP_REACH))
        final = median(dense[cut])
        if cleaning.sharpen:
            final = median(sharpen_edges(final, grey[cut]))
        out.disparity[y0:y1] = final[own]
        out.confidence[y0:y1] = confidence(matches[cut], final, quality[cut], by_quality)[own]

    # A block is cut out with a margin, filtered like a separate picture on one thread, and its own rows are kept.
    in_blocks(grey.shape[0], block)
    return out


def enlarge(small: DenseMatches, grey: UInt8[np.ndarray, "h w"]) -> DenseMatches:
    """Enlarge a map to twice its size: linear within a surface, edges decided by `grey`, the larger left view."""
    out = _empty(grey.shape)
    frame = np.pad(small.disparity, 1, mode="edge")

    def block(y0: int, y1: int) -> None:
        cut, own = slices_with_margin(y0, y1, VOTERS)
        part = _empty(grey[cut].shape)
        _enlarge(frame, small.confidence, cut.start, *part)
        out.disparity[y0:y1] = sharpen_edges(part.disparity, grey[cut])[own]
        out.confidence[y0:y1] = part.confidence[own]

    in_blocks(grey.shape[0], block)
    return out


def to_disparity_map(dense: DenseMatches, grey: UInt8[np.ndarray, "h w"], fill: bool) -> DisparityMap:
    """Convert to pixels; NaN where nothing is known and, unless `fill`, where the value comes from neighbours."""
    disparity_px, trust = np.empty(grey.shape, np.float32), np.empty(grey.shape, np.float32)

    def block(y0: int, y1: int) -> None:
        cut, own = slices_with_margin(y0, y1, FLAT_REACH)
        rows = (values[y0:y1] for values in (*dense, disparity_px, trust))
        _to_pixels(flat_pixels(grey[cut])[own], fill, *rows)

    in_blocks(grey.shape[0], block)
    return DisparityMap(disparity_px, trust)


@njit(**KERNEL)
def _to_pixels(flat, fill, disparity, confidence, disparity_px, trust):
    for y in range(disparity.shape[0]):
        for x in range(disparity.shape[1]):
            value = np.float32(0) if flat[y, x] else confidence[y, x]
            is_valid = disparity[y, x] != UNKNOWN and (fill or value > np.float32(FILLED))
            trust[y, x] = value if is_valid else np.float32(0)
            disparity_px[y, x] = np.float32(disparity[y, x]) * np.float32(1 / 16) if is_valid else np.float32(np.nan)


@njit(**KERNEL)
def _enlarge(frame, trust, y0, out, out_trust):
    """Enlarge the rows from y0 on; `padded` is the small map with its edge repeated once."""
    # A pixel lies a quarter of a small pixel off the centre of that one: 3/4 of its value, 1/4 of the neighbour's.
    for i in range(out.shape[0]):
        y = y0 + i
        near, other = frame[(y >> 1) + 1], frame[(y >> 1) + 2 * (y & 1)]
        for odd in range(2):  # every other column, so that neither loop has a branch
            for x in range((out.shape[1] + 1 - odd) >> 1):
                own = int32(near[x + 1])
                total = 4 * own + _step(own, near[x + 2 * odd]) + _step(own, other[x + 1])
                out[i, 2 * x + odd] = UNKNOWN if own == UNKNOWN else max(min(total >> 1, 32767), -32767)
                out_trust[i, 2 * x + odd] = trust[y >> 1, x]


@inner()
def _step(own, other):
    step = int32(other) - own
    return step if abs(step) <= SAME_SURFACE else int32(0)


def median(disparity: Int16[np.ndarray, "h w"]) -> Int16[np.ndarray, "h w"]:
    """Filter with a 5 x 5 median; the picture's edge is repeated outwards."""
    return cv2.medianBlur(disparity, 2 * MEDIAN_REACH + 1)  # pyright: ignore[reportReturnType]


def sharpen_edges(disparity: Int16[np.ndarray, "h w"], grey: UInt8[np.ndarray, "h w"]) -> Int16[np.ndarray, "h w"]:
    """Move each pixel near a depth edge to the surface that its grey value votes for."""
    window = np.ones((2 * NEARBY + 1, 2 * NEARBY + 1), np.uint8)
    out = disparity.copy()
    around = VOTERS, VOTERS, VOTERS, LANES
    ranks = cv2.copyMakeBorder(disparity.view(np.uint16) + ZERO_RANK, *around, cv2.BORDER_REPLICATE)
    greys = cv2.copyMakeBorder(grey.astype(np.uint16), *around, cv2.BORDER_CONSTANT, value=NO_GREY)
    far, near = cv2.erode(disparity, window), cv2.dilate(disparity, window)
    _vote(Lanes(LANES), VOTING, ranks, greys, disparity, grey, far, near, out)
    return out


@njit(**KERNEL)
def _vote(lanes, voting, ranks, greys, disparity, grey, far, near, out):
    h, w = disparity.shape
    # Windows and paths let a near surface grow over its neighbour by a pixel or two. Near a depth edge, the pixels of a
    # small window vote for one of the two surfaces, the more alike their grey value is, the more; the rest has no
    # choice.
    for y in range(h):
        for x in range(w):
            lowest, highest = int32(far[y, x]), int32(near[y, x])
            if highest - lowest >= JUMP:
                middle = np.int16((lowest + highest) >> 1)
                front = _majority(lanes, voting, ranks, greys, y, x, middle)
                if (disparity[y, x] > middle) != (front > 0) and front != 0:
                    out[y, x] = _mean_of_side(disparity, grey, y, x, middle, front > 0)


@inner()
def _majority(lanes, voting, ranks, greys, y, x, middle):
    """Return the votes for the front minus those for the back. A row of the window fits the lanes; not all vote."""
    own = splat(lanes, greys[y + VOTERS, x + VOTERS])
    border, one = splat(lanes, uint16(middle + ZERO_RANK)), splat(lanes, uint16(1))
    reach = splat(lanes, uint16(GREY_REACH))
    voters = load(lanes, voting, 0)
    front = every = splat(lanes, uint16(0))
    for v in range(y, y + 2 * VOTERS + 1, STRIDE):
        rank, shade = load(lanes, ranks[v], x), load(lanes, greys[v], x)
        difference = subtract(maximum(shade, own), minimum(shade, own))
        weight = multiply(subtract(reach, minimum(difference, reach)), voters)
        every = add(every, weight)
        front = add(front, multiply(weight, minimum(subtract(maximum(rank, border), border), one)))
    return 2 * int32(total(front)) - int32(total(every))


@inner(error_model="python")
def _mean_of_side(disparity, grey, y, x, middle, front):
    h, w = disparity.shape
    own = int32(grey[y, x])
    weights = total = int32(0)
    for v in range(y - VOTERS, y + VOTERS + 1, STRIDE):
        for u in range(x - VOTERS, x + VOTERS + 1, STRIDE):
            if not (0 <= v < h and 0 <= u < w):
                continue
            if (disparity[v, u] > middle) == front:
                weight = max(int32(GREY_REACH) - abs(int32(grey[v, u]) - own), int32(0))
                weights += weight
                total += weight * disparity[v, u]
    return np.int16(total // weights)
