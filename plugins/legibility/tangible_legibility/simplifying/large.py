"""Merging of segments into few large parts, for a person to name."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float, Int, UInt8
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from tangible_core.data import PartMap, SegmentMap, border_pixels, check_same_shape, to_rgb8
from tangible_core.parts import find_parts
from tangible_core.parts.neighbours import neighbours
from tangible_core.runtime import plain_opencv

LIGHTNESS_IN_BYTES = (100 / 255, 1.0, 1.0)
"""Factors from OpenCV's CIELAB in bytes to units of CIELAB."""
Each = Float[np.ndarray, "n"]


def large_parts(segments: SegmentMap, picture: np.ndarray, least_px: float, most: int) -> PartMap:
    """Merge the parts of the segments until none is a speck, and at most `most` are left.

    A speck, a part that holds no disc least_px wide, joins the neighbour with the longest common border and the most
    similar colour (CIELAB). Then, while there are more than `most`, those two neighbours join that increase the spread
    of the colours within parts least (Ward, Hierarchical grouping to optimize an objective function, 1963). One part is
    left if the whole picture is narrower than least_px.
    Raises: PictureError for an array that is not a picture, or of another size.
    """
    check_same_shape("the picture", picture[..., 0] if picture.ndim == 3 else picture, "its segments", segments.labels)
    parts, colours = find_parts(segments), _colours(picture)
    while parts.count > 1 and (specks := disc_widths(parts) < least_px).any():
        parts = _relabel(parts, _join_specks(parts, colours, specks))
    if parts.count > most:
        parts = _relabel(parts, _join_similar(parts, colours, most))
    return find_parts(SegmentMap(parts.labels))


def disc_widths(parts: PartMap) -> Each:
    """Return the diameter of the largest disc within each part, in pixels; the picture's rim is a border."""
    import cv2

    inside = ~border_pixels(np.pad(parts.labels, 1, constant_values=-1))
    with plain_opencv():
        depth = cv2.distanceTransform(inside.view(np.uint8), cv2.DIST_L2, 5)[1:-1, 1:-1]
    deepest = np.zeros(parts.count, np.float32)
    np.maximum.at(deepest, parts.labels.reshape(-1), depth.reshape(-1))
    return 2 * deepest.astype(np.float64) + 1


def _colours(picture: np.ndarray) -> UInt8[np.ndarray, "h w 3"]:
    """Convert to CIELAB in bytes, as OpenCV packs it; finer differences do not matter here."""
    import cv2

    with plain_opencv():
        return cv2.cvtColor(to_rgb8(picture), cv2.COLOR_RGB2LAB).astype(np.uint8, copy=False)


class _Means(NamedTuple):
    size_px: Each
    colour: Float[np.ndarray, "n 3"]


def _means(parts: PartMap, colours: UInt8[np.ndarray, "h w 3"]) -> _Means:
    flat = parts.labels.reshape(-1)
    size_px = np.bincount(flat, minlength=parts.count).astype(np.float64)
    sums = [np.bincount(flat, colours[..., channel].reshape(-1), minlength=parts.count) for channel in range(3)]
    return _Means(size_px, np.stack(sums, axis=1) / size_px[:, None] * LIGHTNESS_IN_BYTES)


def _join_specks(
    parts: PartMap, colours: UInt8[np.ndarray, "h w 3"], specks: Bool[np.ndarray, "n"]
) -> Int[np.ndarray, "n"]:
    """Return the part that each part joins; specks that choose each other join, and may be large enough then."""
    low, high, sides = neighbours(parts)
    first, second = np.concatenate([low, high]), np.concatenate([high, low])
    sides = np.concatenate([sides, sides])
    rim = np.bincount(first, sides, minlength=parts.count)
    colour = _means(parts, colours).colour
    unlike = 1 + np.linalg.norm(colour[first] - colour[second], axis=1)
    cost = np.where(specks[first], unlike * rim[first] / sides, np.inf)
    order = np.lexsort((cost, first))
    chosen = order[np.searchsorted(first[order], np.flatnonzero(specks))]
    joined = coo_array((np.ones(chosen.size), (first[chosen], second[chosen])), (parts.count, parts.count))
    return connected_components(joined, directed=False)[1]


def _join_similar(parts: PartMap, colours: UInt8[np.ndarray, "h w 3"], most: int) -> Int[np.ndarray, "n"]:
    """Return the part that each part joins when the most similar neighbours join until `most` are left."""
    size_px, colour = _means(parts, colours)
    near = np.zeros((parts.count, parts.count), np.bool_)
    low, high, _ = neighbours(parts)
    near[low, high] = near[high, low] = True
    belongs = np.arange(parts.count)
    for _ in range(parts.count - max(1, most)):
        spread = np.square(colour[:, None] - colour).sum(axis=2)
        cost = np.where(near, spread * size_px[:, None] * size_px / (size_px[:, None] + size_px), np.inf)
        kept, gone = divmod(int(cost.argmin()), parts.count)
        both = size_px[kept] + size_px[gone]
        colour[kept] = (size_px[kept] * colour[kept] + size_px[gone] * colour[gone]) / both
        size_px[kept] = both
        near[kept] |= near[gone]
        near[:, kept] = near[kept]
        near[kept, kept] = False
        near[gone] = near[:, gone] = False
        belongs[belongs == gone] = kept
    return belongs


def _relabel(parts: PartMap, belongs: Int[np.ndarray, "n"]) -> PartMap:
    """Replace each part by the one that it joins, with numbers in order."""
    names, numbers = np.unique(belongs, return_inverse=True)
    return PartMap(numbers.astype(np.int32)[parts.labels], tuple(range(names.size)))
