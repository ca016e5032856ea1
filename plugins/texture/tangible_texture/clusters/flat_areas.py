"""Pictures of a few flat areas, which no texture tells apart."""

from math import pi, sqrt

import cv2
import numpy as np
from jaxtyping import Int32

from tangible_core.runtime import plain_opencv

from ..features.cells import channels
from ..signal.smoothing import gaussian

SMOOTH_PX = 2.0
WHITE = 1 / (2 * sqrt(pi) * SMOOTH_PX)  # share of the deviation of white noise that this Gaussian leaves
INSIDE_PX = 5  # distance from a change of tone at which a pixel is inside of an area, px
MAX_AREAS = 32
# Largest deviation of the noise of a sensor, as a share of what the tones differ by: beyond, it is a texture.
SENSOR = 0.05
# Largest change of tone within an area without noise, as a share of the brightest tone.
ROUNDING = 1.5 / 255
DEVIATIONS = 6  # largest change of tone within an area, in standard deviations of the noise that is left


def flat_areas(picture: np.ndarray, colour: bool, most: int) -> Int32[np.ndarray, "h w"] | None:
    """Return the tone of each pixel of up to `most` flat tones, but for a sensor's noise; else None."""
    paint = channels(picture, colour)
    smooth = gaussian(paint, SMOOTH_PX)
    noise = float(np.median(np.abs(paint - smooth))) / 0.6745
    if noise > SENSOR:
        return None
    step = max(ROUNDING, DEVIATIONS * WHITE * noise)
    window = np.ones((2 * INSIDE_PX + 1,) * 2, np.uint8)
    with plain_opencv():
        change = np.atleast_3d(cv2.dilate(smooth, window) - cv2.erode(smooth, window)).max(axis=2)
        away, areas = cv2.distanceTransformWithLabels((change > step).astype(np.uint8), cv2.DIST_L2, 5)
    if not 0 < areas.max() <= MAX_AREAS or away.max() > 3 * INSIDE_PX:
        return None
    inside = change <= step
    tones: list[np.ndarray] = []
    tone_of_area = np.zeros(int(areas.max()) + 1, np.int32)
    for area in range(1, len(tone_of_area)):
        values = smooth[inside & (areas == area)]
        if (values.std(axis=0) > step / 3).any():
            return None
        near = [index for index, tone in enumerate(tones) if (np.abs(values.mean(axis=0) - tone) <= step).all()]
        tone_of_area[area] = near[0] if near else len(tones)
        tones += [] if near else [values.mean(axis=0)]
    apart = float(np.ptp(tones, axis=0).max()) if len(tones) > 1 else 1.0
    return tone_of_area[areas] if len(tones) <= most and noise <= SENSOR * apart else None
