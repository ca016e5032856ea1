"""Tones: a rising map from nearness to height that gives most height to those depths which borders cross."""

import numpy as np
from jaxtyping import Float32, Float64

BINS = 256
"""Places of the map, less one: as many as a lookup table of OpenCV has."""
BORDER = 0.03
"""The least difference of nearness of two cells at a border, of its whole range."""
REACH = 2
"""Distance between these two cells: matched borders are one or two cells wide."""
STEEPEST = 4.0
"""The greatest density of borders, over its mean; what is cut off is shared out to all depths."""
STRAIGHT = np.linspace(0, 1, BINS + 1)
"""Tones that keep heights proportional to nearness."""


def tones_of(nearness: Float32[np.ndarray, "h w"], share: float) -> Float64[np.ndarray, "n"]:
    """Return the heights, 0 to 1, of BINS + 1 evenly spaced values of nearness from 0 to 1.

    Each border counts once, however high: its weight is spread evenly over the depths between its two sides. The slope
    of the map is at least 1 - share and at most 1 + share STEEPEST; without borders it is 1.
    Source: Pizer et al. 1987, the clipped histogram, here of borders in place of pixels.
    """
    density = _border_density(nearness) if share else np.zeros(BINS)
    if not density.any():
        return STRAIGHT
    cut = np.minimum(density / density.mean(), STEEPEST)
    slope = share * (cut + 1 - cut.mean()) + 1 - share
    return np.concatenate([[0], np.cumsum(slope) / BINS])


def apply_tones(nearness: Float32[np.ndarray, "h w"], tones: Float64[np.ndarray, "n"]) -> Float32[np.ndarray, "h w"]:
    """Return the heights of these values of nearness, 0 to 1, interpolated between the places of the map."""
    import cv2

    place = nearness * np.float32(BINS)
    below = np.minimum(np.floor(place), np.float32(BINS - 1))
    place -= below
    index = below.astype(np.uint8)
    place *= cv2.LUT(index, np.diff(tones).astype(np.float32))
    place += cv2.LUT(index, tones[:-1].astype(np.float32))
    return place


def _border_density(nearness: Float32[np.ndarray, "h w"]) -> Float64[np.ndarray, "n"]:
    """Return how many borders cross each of BINS depths."""
    change = np.zeros(BINS + 1)
    for one, other in ((nearness[:, REACH:], nearness[:, :-REACH]), (nearness[REACH:], nearness[:-REACH])):
        at_border = np.abs(one - other) > BORDER
        one, other = one[at_border], other[at_border]
        low, high = np.minimum(one, other), np.maximum(one, other)
        weight = 1 / (high - low).astype(np.float64)
        change += np.bincount((low * BINS).astype(np.int32), weight, BINS + 1)
        change -= np.bincount((high * BINS).astype(np.int32), weight, BINS + 1)
    return np.maximum(np.cumsum(change)[:BINS], 0)
