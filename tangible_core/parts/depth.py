"""Heights of parts from their median disparity."""

import numpy as np
from jaxtyping import Float32, Float64, Int64

from ..data import DisparityMap, PartMap
from ..data.pictures import check_same_shape
from .find import part_sizes
from .heights import PartHeights
from .neighbours import neighbours

# Shares of the picture, counted from the farthest part, between which the heights run; others are clipped.
RANGE = (0.005, 0.995)


def depth_heights(parts: PartMap, disparity: DisparityMap, top_m: float) -> PartHeights:
    """Return a height for each part by its median disparity, 0 to top_m for the nearest. Raises: PictureError."""
    check_same_shape("the disparity", disparity.disparity_px, "the map of the parts", parts.labels)
    medians, known_pixels = part_medians(parts, disparity.disparity_px)
    sizes = part_sizes(parts)
    depths = _fill(parts, medians)
    # But for 0.5 % of the picture, so that a small part with a wrong depth does not press all others flat.
    heights_m = top_m * _between(depths, sizes)
    unit = " px" if disparity.unit == "px" else ""
    return PartHeights(
        tuple(heights_m.tolist()),
        tuple(
            f"its median disparity is {median:.3g}{unit}, known of {100 * pixels / size:.0f} % of it"
            if pixels
            else "its disparity is known nowhere, so it lies as far back as its farthest neighbour"
            for median, pixels, size in zip(medians, known_pixels, np.maximum(sizes, 1), strict=True)
        ),
    )


def part_medians(
    parts: PartMap, values: Float32[np.ndarray, "h w"]
) -> tuple[Float64[np.ndarray, "n"], Int64[np.ndarray, "n"]]:
    """Return the median of the finite values over each part, NaN for a part without any, and their number."""
    finite = np.isfinite(values)
    labels, numbers = parts.labels[finite].astype(np.uint64), values[finite] + np.float32(0)  # adding makes -0 a 0
    bits = numbers.view(np.uint32)
    sortable = np.where(bits >> 31, ~bits, bits | np.uint32(1 << 31))  # whole numbers in the order of the values
    keys = np.sort(labels << np.uint64(32) | sortable)
    counts = np.bincount(labels.astype(np.int64), minlength=parts.count)
    starts = np.cumsum(counts) - counts
    some = counts > 0
    medians = np.full(parts.count, np.nan)
    middle = [_value(keys[(starts + (counts - 1 + more) // 2)[some]]) for more in (0, 1)]
    medians[some] = (middle[0] + middle[1]) / 2
    return medians, counts


def _value(keys: np.ndarray) -> Float64[np.ndarray, "n"]:
    sortable = (keys & np.uint64(0xFFFFFFFF)).astype(np.uint32)
    bits = np.where(sortable >> 31, sortable & np.uint32(0x7FFFFFFF), ~sortable)
    return bits.view(np.float32).astype(np.float64)


def _fill(parts: PartMap, medians: Float64[np.ndarray, "n"]) -> Float64[np.ndarray, "n"]:
    """Replace NaN by the least of the known neighbours, spreading outwards from known parts."""
    depths = np.where(np.isnan(medians), np.inf, medians)
    unknown = np.isinf(depths)
    if unknown.all():
        return np.zeros_like(medians)
    pairs = neighbours(parts) if unknown.any() else None
    # Hidden surfaces lie behind.
    while pairs is not None and (open_parts := np.isinf(depths)).any():
        least = np.full(parts.count, np.inf)
        np.minimum.at(least, pairs.low, depths[pairs.high])
        np.minimum.at(least, pairs.high, depths[pairs.low])
        if not np.isfinite(least[open_parts]).any():  # parts without a pixel have no neighbour
            break
        depths = np.where(open_parts, least, depths)
    return np.where(np.isinf(depths), depths[~np.isinf(depths)].min(), depths)


def _between(depths: Float64[np.ndarray, "n"], sizes: Int64[np.ndarray, "n"]) -> Float64[np.ndarray, "n"]:
    """Scale depths from 0 for the farthest to 1 for the nearest; 0 if these are equal."""
    order = np.argsort(depths, kind="stable")
    upto = np.cumsum(sizes[order])
    low, high = (
        depths[order][min(int(np.searchsorted(upto, share * float(upto[-1]))), depths.size - 1)] for share in RANGE
    )
    if not low < high:
        low, high = depths.min(), depths.max()
    if not low < high:
        return np.zeros_like(depths)
    return np.clip((depths - low) / (high - low), 0, 1)
