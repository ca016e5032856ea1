"""Merging of segments into few large parts, and of similar textures."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float, Float64, Int, Int32, Int64, UInt8
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from tangible_core.data import PartMap, SegmentMap, border_pixels, check_same_shape, to_rgb8
from tangible_core.parts import find_parts
from tangible_core.parts.neighbours import neighbours
from tangible_core.runtime import cv2, plain_opencv

LIGHTNESS_IN_BYTES = (100 / 255, 1.0, 1.0)  # OpenCV's CIELAB in bytes -> CIELAB
Each = Float[np.ndarray, "n"]


def large_parts(segments: SegmentMap, picture: np.ndarray, least_px: float, most: int) -> PartMap:
    """Merge the parts of the segments until none is a speck, narrower than least_px, and at most `most` are left."""
    check_same_shape("the picture", picture[..., 0] if picture.ndim == 3 else picture, "its segments", segments.labels)
    # Specks join the most similar neighbour with the longest border; then Ward, Hierarchical grouping, JASA 1963.
    parts, colours = find_parts(segments), _colours(picture)
    while parts.count > 1 and (specks := disc_widths(parts) < least_px).any():
        parts = _relabel(parts, _join_specks(parts, colours, specks))
    if parts.count > most:
        parts = _relabel(parts, _join_similar(parts, colours, most))
    return find_parts(SegmentMap(parts.labels))


def disc_widths(parts: PartMap) -> Each:
    """Return the diameter of the largest disc within each part, in pixels; the picture's rim is a border."""
    inside = ~border_pixels(np.pad(parts.labels, 1, constant_values=-1))
    with plain_opencv():
        depth = cv2.distanceTransform(inside.view(np.uint8), cv2.DIST_L2, 5)[1:-1, 1:-1]
    deepest = np.zeros(parts.count, np.float32)
    np.maximum.at(deepest, parts.labels.reshape(-1), depth.reshape(-1))
    return 2 * deepest.astype(np.float64) + 1


def _colours(picture: np.ndarray) -> UInt8[np.ndarray, "h w 3"]:
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
    choices = order[np.searchsorted(first[order], np.flatnonzero(specks))]
    targets = coo_array((np.ones(choices.size), (first[choices], second[choices])), (parts.count, parts.count))
    return connected_components(targets, directed=False)[1]


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
        survivor, gone = divmod(int(cost.argmin()), parts.count)
        both = size_px[survivor] + size_px[gone]
        colour[survivor] = (size_px[survivor] * colour[survivor] + size_px[gone] * colour[gone]) / both
        size_px[survivor] = both
        near[survivor] |= near[gone]
        near[:, survivor] = near[survivor]
        near[survivor, survivor] = False
        near[gone] = near[:, gone] = False
        belongs[belongs == gone] = survivor
    return belongs


def _relabel(parts: PartMap, belongs: Int[np.ndarray, "n"]) -> PartMap:
    names, numbers = np.unique(belongs, return_inverse=True)
    return PartMap(numbers.astype(np.int32)[parts.labels], tuple(range(names.size)))


MAX_COMPARED = 256  # textures that are compared pairwise; smaller ones go to the most similar
FAR = 1000.0  # between figure and ground: more than any two colours differ


def count_textures(parts: PartMap, names: Sequence[str] = ()) -> int:
    """Count the textures of the parts that have a pixel: one a segment, without parts that a name distinguishes."""
    present = np.flatnonzero(np.bincount(parts.labels.reshape(-1), minlength=parts.count))
    return len({parts.segments[n] for n in present.tolist() if n >= len(names) or not names[n]})


def texture_kinds(
    parts: PartMap, names: Sequence[str], textures: int, picture: np.ndarray | None, front: Sequence[int] = ()
) -> Int32[np.ndarray, "n"]:
    """Return the kind of each part, from 0 on: one for each named part, at most `textures` for the others."""
    most, figure = max(parts.segments, default=0) + 1, set(front)
    keys = [
        -1 - n if n < len(names) and names[n] else segment + most * (n in figure)
        for n, segment in enumerate(parts.segments)
    ]
    order = {key: at for at, key in enumerate(dict.fromkeys(keys))}
    kinds = np.array([order[key] for key in keys], np.int32)
    size = np.bincount(kinds[parts.labels].reshape(-1), minlength=len(order))
    free = np.array([at for key, at in order.items() if key >= 0 and size[at]], np.int64)
    if free.size > textures:
        colour = np.zeros((len(order), 3)) if picture is None else _mean_colours(picture, kinds[parts.labels], size)
        colour[:, 0] += FAR * np.array([key >= most for key in order])
        into = np.arange(len(order), dtype=np.int32)
        into[free] = free[_merge(size[free].astype(np.float64), colour[free], textures, picture is not None)]
        kinds = into[kinds]
    _, dense = np.unique(kinds, return_inverse=True)
    return dense.astype(np.int32)


def _mean_colours(
    picture: np.ndarray, kinds: Int32[np.ndarray, "h w"], size: Int64[np.ndarray, "k"]
) -> Float64[np.ndarray, "k 3"]:
    with plain_opencv():
        small = cv2.resize(to_rgb8(picture), kinds.shape[::-1], interpolation=cv2.INTER_AREA)
        lab = np.asarray(cv2.cvtColor(small.astype(np.float32) / np.float32(255), cv2.COLOR_RGB2LAB))
    flat = kinds.reshape(-1)
    sums = [np.bincount(flat, lab[..., channel].reshape(-1), size.size) for channel in range(3)]
    return np.stack(sums, axis=1) / np.maximum(size, 1)[:, None]


def _merge(
    size: Float64[np.ndarray, "k"], colour: Float64[np.ndarray, "k 3"], most: int, coloured: bool
) -> Int64[np.ndarray, "k"]:
    """Merge kinds until at most `most` are left; return the kind that each goes into."""
    into = np.arange(size.size)
    alive = np.sort(np.argsort(-size, kind="stable")[:MAX_COMPARED])
    for kind in np.setdiff1d(into, alive).tolist():
        into[kind] = alive[np.square(colour[alive] - colour[kind]).sum(axis=1).argmin()]
    size = np.bincount(into, size, into.size)
    colour = colour.copy()
    while alive.size > most:
        apart = np.square(colour[alive][:, None] - colour[alive]).sum(axis=2) if coloured else 1.0
        cost = apart * np.outer(size[alive], size[alive]) / np.add.outer(size[alive], size[alive])
        np.fill_diagonal(cost, np.inf)
        one, other = (int(alive[kind]) for kind in divmod(int(cost.argmin()), alive.size))
        stays, goes = (one, other) if size[one] >= size[other] else (other, one)
        both = size[stays] + size[goes]
        colour[stays] = (size[stays] * colour[stays] + size[goes] * colour[goes]) / both
        size[stays] = both
        into[into == goes] = stays
        alive = alive[alive != goes]
    return into
