"""Heights of the features of a relief, width by width, and the thresholds from which they are felt."""

import math
from typing import Any

import numpy as np
from jaxtyping import Float64

from ..data import Relief
from ..runtime.opencv import cv2, plain_opencv
from ..scene.geometry import resample

FELT = ((3.2e-3, 29e-6), (10e-3, 130e-6))
"""(width, height) of Gaussian profiles that a bare hand just distinguishes from a flat surface, metres."""
# Widths of the features measured; from 1 mm on the thresholds follow one power of the width.
WIDTHS_M = (1e-3, 3.2e-3, 10e-3, 32e-3)
# Standard deviations of the Gaussians whose difference passes a feature, as shares of its width.
FINE, COARSE = 0.5, 2.0
# Fewest cells a feature's width to which a fine relief is reduced before it is filtered.
PER_WIDTH = 4


def threshold_m(width_m: float) -> float:
    """Return the height from which a bump of this width is felt: a straight line through FELT, in logarithms.

    Source: Louw, Kappers & Koenderink, Exp. Brain Research 132 (2000): 1 to 240 mm, a power of about 1.3.

    >>> round(1e6 * threshold_m(0.0032), 6), round(1e6 * threshold_m(0.01), 6)
    (29.0, 130.0)
    """
    (near, low), (far, high) = FELT
    return low * (width_m / near) ** (math.log(high / low) / math.log(far / near))


def leakage(width_m: float, band_m: float) -> float:
    """Return the response to a hill in the band of another width, as a share of the response in its own band."""
    return _response(width_m, band_m, 2) / _response(width_m, width_m, 2)


def _response(width_m: float, band_m: float, sides: int) -> float:
    """Return the share of the height of a long ridge (sides 1) or a round hill (2) that a band passes."""
    fine, coarse = (width_m / math.hypot(width_m, share * band_m) for share in (FINE, COARSE))
    return fine**sides - coarse**sides


def feature_m(relief: Relief, width_m: float) -> float:
    """Return the height or depth of the greatest feature about this wide: exact for a long Gaussian ridge."""
    # A sine of amplitude a and wavelength L counts as a (exp(-u/8) - exp(-2u)) / 0.447, u = (2 pi width / L)^2: at most
    # 1.74 a, at L = 5.2 widths. The point-symmetric continuation beyond the borders gives a plane no feature.
    relief = reduce_relief(relief, width_m / PER_WIDTH)
    across, along = (width_m / pitch for pitch in relief.pitch_m)
    margin = [math.ceil(4 * COARSE * cells) for cells in (along, across)]
    heights = np.pad(
        relief.height_m.astype(np.float64), [(cells, cells) for cells in margin], "reflect", reflect_type="odd"
    )

    def blur(share: float) -> Any:
        with plain_opencv():
            return cv2.GaussianBlur(heights, (0, 0), share * across, sigmaY=share * along)

    rows, columns = relief.height_m.shape
    band: Float64[np.ndarray, "h w"] = blur(FINE) - blur(COARSE)
    inner = band[margin[0] : margin[0] + rows, margin[1] : margin[1] + columns]
    return float(np.abs(inner).max()) / _response(width_m, width_m, 1)


def reduce_relief(relief: Relief, pitch_m: float) -> Relief:
    """Resample a relief to cells of about this size if its cells are smaller."""
    rows, columns = (
        min(count, max(1, math.ceil(length / pitch_m)))
        for count, length in zip(relief.height_m.shape, reversed(relief.extent_m), strict=True)
    )
    return resample(relief, (rows, columns))
