"""How high the features of a relief are, width by width, and how high they must be to be felt."""

import math
from typing import Any

import numpy as np
from jaxtyping import Float64

from ..data import Relief
from ..runtime.opencv import plain_opencv
from ..scene.geometry import resample

FELT = ((3.2e-3, 29e-6), (10e-3, 130e-6))
"""Width of a Gaussian profile, and the height from which a bare hand tells it from a flat surface, metres."""
WIDTHS_M = (1e-3, 3.2e-3, 10e-3, 32e-3)
"""The widths that are looked at; from 1 mm on the thresholds follow one power of the width."""
FINE, COARSE = 0.5, 2.0
"""Of a feature's width: the Gaussians whose difference passes it."""
PER_WIDTH = 4
"""Cells to a feature's width, at least, when a fine relief is reduced before it is filtered."""


def threshold_m(width_m: float) -> float:
    """The height from which a bump of this width is felt: a straight line through FELT, in logarithms.

    Source: Louw, Kappers & Koenderink, Exp. Brain Research 132 (2000): 1 to 240 mm, a power of about 1.3.

    >>> round(1e6 * threshold_m(0.0032), 6), round(1e6 * threshold_m(0.01), 6)
    (29.0, 130.0)
    """
    (near, low), (far, high) = FELT
    return low * (width_m / near) ** (math.log(high / low) / math.log(far / near))


def left_over(width_m: float, band_m: float) -> float:
    """What a hill shows in the band of another width, a share of what it shows in its own."""
    return _passed(width_m, band_m, 2) / _passed(width_m, width_m, 2)


def _passed(width_m: float, band_m: float, sides: int) -> float:
    """Share of the height of a long ridge (1) or a round hill (2): a Gaussian widens another, and keeps its volume."""
    fine, coarse = (width_m / math.hypot(width_m, share * band_m) for share in (FINE, COARSE))
    return fine**sides - coarse**sides


def feature_m(relief: Relief, width_m: float) -> float:
    """Height or depth of the greatest feature about this wide: exact for a long ridge of Gaussian profile.

    A sine of amplitude a and wavelength L counts as a (exp(-u/8) - exp(-2u)) / 0.447, u = (2 pi width / L)^2: at most
    1.74 a, at L = 5.2 widths. Beyond its borders the relief goes on point-symmetrically: a plane has no feature.
    """
    import cv2

    relief = reduced(relief, width_m / PER_WIDTH)
    across, along = (width_m / pitch for pitch in relief.pitch_m)
    margin = [math.ceil(4 * COARSE * cells) for cells in (along, across)]
    heights = np.pad(
        relief.height_m.astype(np.float64), [(each, each) for each in margin], "reflect", reflect_type="odd"
    )

    def blurred(share: float) -> Any:
        with plain_opencv():
            return cv2.GaussianBlur(heights, (0, 0), share * across, sigmaY=share * along)

    rows, columns = relief.height_m.shape
    band: Float64[np.ndarray, "h w"] = blurred(FINE) - blurred(COARSE)
    inner = band[margin[0] : margin[0] + rows, margin[1] : margin[1] + columns]
    return float(np.abs(inner).max()) / _passed(width_m, width_m, 1)


def reduced(relief: Relief, pitch_m: float) -> Relief:
    """The relief in cells of about this size, where its own are smaller."""
    rows, columns = (
        min(count, max(1, math.ceil(length / pitch_m)))
        for count, length in zip(relief.height_m.shape, reversed(relief.extent_m), strict=True)
    )
    return resample(relief, (rows, columns))
