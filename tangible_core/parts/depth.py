"""Heights of parts by the disparity that is known of them."""

import numpy as np
from jaxtyping import Float32, Float64, Int64

from ..data import DisparityMap, PartMap
from ..data.pictures import check_same_shape
from .find import part_sizes
from .heights import PartHeights
from .neighbours import neighbours

RANGE = (0.005, 0.995)
"""The shares of the picture, from the farthest part on, between which the heights run; what lies beyond is clipped."""


def depth_heights(parts: PartMap, disparity: DisparityMap, top_m: float) -> PartHeights:
    """A height for each part by the median of the disparity over it: 0 for the farthest, top_m for the nearest.

    The median is one of the connected part, over what is known of it; wrong matches at its rim do not move it. Heights
    are linear in disparity, between the farthest and the nearest but for 0.5 % of the picture, so that a small part
    with a wrong depth does not press all others flat. A part of which nothing is known is as far as the farthest of its
    neighbours, as what is hidden lies behind.
    Raises: PictureError if the disparity is of another size than the parts.
    """
    check_same_shape("the disparity", disparity.disparity_px, "the map of the parts", parts.labels)
    medians, known = medians_of(parts, disparity.disparity_px)
    sizes = part_sizes(parts)
    depths = _filled(parts, medians)
    heights_m = top_m * _between(depths, sizes)
    unit = " px" if disparity.unit == "px" else ""
    return PartHeights(
        tuple(heights_m.tolist()),
        tuple(
            f"its median disparity is {median:.3g}{unit}, known of {100 * pixels / size:.0f} % of it"
            if pixels
            else "its disparity is known nowhere, so it lies as far back as the farthest part beside it"
            for median, pixels, size in zip(medians, known, np.maximum(sizes, 1), strict=True)
        ),
    )


def medians_of(
    parts: PartMap, values: Float32[np.ndarray, "h w"]
) -> tuple[Float64[np.ndarray, "n"], Int64[np.ndarray, "n"]]:
    """The median of the finite values over each part, NaN for a part without any, and how many they are."""
    finite = np.isfinite(values)
    labels, found = parts.labels[finite].astype(np.uint64), values[finite] + np.float32(0)  # which makes -0 a 0
    bits = found.view(np.uint32)
    ordered = np.where(bits >> 31, ~bits, bits | np.uint32(1 << 31))  # as the values are, and as whole numbers
    keys = np.sort(labels << np.uint64(32) | ordered)
    counts = np.bincount(labels.astype(np.int64), minlength=parts.count)
    starts = np.cumsum(counts) - counts
    some = counts > 0
    medians = np.full(parts.count, np.nan)
    middle = [_value(keys[(starts + (counts - 1 + more) // 2)[some]]) for more in (0, 1)]
    medians[some] = (middle[0] + middle[1]) / 2
    return medians, counts


def _value(keys: np.ndarray) -> Float64[np.ndarray, "n"]:
    """The values of which these are the keys."""
    ordered = (keys & np.uint64(0xFFFFFFFF)).astype(np.uint32)
    bits = np.where(ordered >> 31, ordered & np.uint32(0x7FFFFFFF), ~ordered)
    return bits.view(np.float32).astype(np.float64)


def _filled(parts: PartMap, medians: Float64[np.ndarray, "n"]) -> Float64[np.ndarray, "n"]:
    """Without NaN: each takes the least of its neighbours that have one, those nearest to them first."""
    found = np.where(np.isnan(medians), np.inf, medians)
    unknown = np.isinf(found)
    if unknown.all():
        return np.zeros_like(medians)
    beside = neighbours(parts) if unknown.any() else None
    while beside is not None and (open_ := np.isinf(found)).any():
        least = np.full(parts.count, np.inf)
        np.minimum.at(least, beside.low, found[beside.high])
        np.minimum.at(least, beside.high, found[beside.low])
        if not np.isfinite(least[open_]).any():  # parts without a pixel here, which are beside none
            break
        found = np.where(open_, least, found)
    return np.where(np.isinf(found), found[~np.isinf(found)].min(), found)


def _between(depths: Float64[np.ndarray, "n"], sizes: Int64[np.ndarray, "n"]) -> Float64[np.ndarray, "n"]:
    """From 0 for the farthest to 1 for the nearest; 0 where these do not differ."""
    order = np.argsort(depths, kind="stable")
    upto = np.cumsum(sizes[order])
    low, high = (
        depths[order][min(int(np.searchsorted(upto, each * float(upto[-1]))), depths.size - 1)] for each in RANGE
    )
    if not low < high:
        low, high = depths.min(), depths.max()
    if not low < high:
        return np.zeros_like(depths)
    return np.clip((depths - low) / (high - low), 0, 1)
