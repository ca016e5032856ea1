"""Borders between the regions of a label map."""

from typing import NamedTuple

import cv2
import numpy as np
from jaxtyping import Float32, Int32, UInt8

from tangible_core.runtime import plain_opencv

from ..signal.smoothing import slopes

_LARGEST = 16000


class Landscape(NamedTuple):
    """Slopes in the channel where they are steepest, in units of the local noise: float32 (h, w) each."""

    steep: Float32[np.ndarray, "h w"]
    across: Float32[np.ndarray, "h w"]
    down: Float32[np.ndarray, "h w"]


def landscape(smooth: Float32[np.ndarray, "h w c"], most: float, noise: Float32[np.ndarray, "r s"]) -> Landscape:
    """Divide slopes by their noise, raised until no slope is above `most`; noise: that with less smoothing."""
    magnitude, across, down, own = slopes(smooth)
    with plain_opencv():
        # Where edges are many, smoothing leaves little flat area between them, and the slopes measured there are not
        # noise: twice the noise with less smoothing bounds it.
        noise = np.minimum(own, 2 * cv2.resize(noise, own.shape[::-1], interpolation=cv2.INTER_LINEAR))
    noise = np.maximum(noise, np.float32(magnitude.max() / most))
    return Landscape(*(slope / noise for slope in (magnitude, across, down)))


def canny_edges(land: Landscape, low: float, high: float, most: float) -> UInt8[np.ndarray, "h w"]:
    """Return 255 within one pixel of Canny's edges, else 0; the thresholds are in units of the noise."""
    unit = _LARGEST / most
    across, down = (np.rint(slope * np.float32(unit)).astype(np.int16) for slope in (land.across, land.down))
    return cv2.dilate(cv2.Canny(across, down, unit * low, unit * high, L2gradient=True), np.ones((3, 3), np.uint8))


Ways = tuple[tuple[slice, slice], tuple[slice, slice]]
"""The slices of the first and of the second pixels of all pairs in one direction."""

# The least slope of an edge on a border of two regions, as a share of the slope that starts an edge elsewhere.
WEAK_EDGE = 2 / 3
ACROSS_IT = 0.45
DOWN: Ways = np.s_[:-1, :], np.s_[1:, :]
ACROSS: Ways = np.s_[:, :-1], np.s_[:, 1:]


class Border(NamedTuple):
    """The border of two neighbouring regions: sums over the pairs of pixels (4 neighbours) across it."""

    pairs: float
    height: float
    edges: float

    def plus(self, other: "Border") -> "Border":
        """Add two borders of one region, with two regions that are merged."""
        return Border(self.pairs + other.pairs, self.height + other.height, self.edges + other.edges)


def borders(
    labels: Int32[np.ndarray, "h w"], land: Landscape, edges: UInt8[np.ndarray, "h w"], edge_slope: float
) -> dict[tuple[int, int], Border]:
    """Return every border by its two regions, the lower label first."""
    count = int(labels.max()) + 1
    # A pair has an edge where `edges` is not 0, and where the picture is as steep as WEAK_EDGE times edge_slope and
    # rises or falls from one pixel to the other: edges without a crest, between the flanks of strong ones or broken by
    # noise. Noise alone has no slope that leads across for long.
    pairs = [
        _pairs(labels, land.steep, edges, slopes, edge_slope, ways, count)
        for slopes, ways in (((land.down, land.across), DOWN), ((land.across, land.down), ACROSS))
    ]
    keys, highest, has_edge = (np.concatenate(parts) for parts in zip(*pairs, strict=True))
    bordering, which, number = np.unique(keys, return_inverse=True, return_counts=True)
    sums = (np.bincount(which, weights, bordering.size).tolist() for weights in (highest, has_edge))
    return {
        divmod(key, count): Border(*sums) for key, *sums in zip(bordering.tolist(), number.tolist(), *sums, strict=True)
    }


def _pairs(
    labels: np.ndarray,
    height: np.ndarray,
    edges: np.ndarray,
    slopes: tuple[np.ndarray, np.ndarray],
    edge_slope: float,
    ways: Ways,
    count: int,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the key, the greater height and an edge flag of every pair in this direction; slopes: along it, across."""
    first, second = ways
    at = np.flatnonzero(labels[first] != labels[second])

    def both(values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return values[first].ravel()[at], values[second].ravel()[at]

    one, other = both(labels)
    keys = np.minimum(one, other).astype(np.int64) * count + np.maximum(one, other)
    leading, aside = (np.add(*both(slope)) for slope in slopes)
    slope = np.hypot(leading, aside)
    steep = (slope >= 2 * WEAK_EDGE * edge_slope) & (np.abs(leading) >= ACROSS_IT * slope)
    return keys, np.maximum(*both(height)), steep | (np.maximum(*both(edges)) > 0)
