"""The borders of a picture's parts that can be felt as steps, under a fingertip that sinks in a little."""

from math import nan
from typing import Any

import numpy as np
from jaxtyping import Bool, Integer

from tangible_core.data import Relief, border_pixels
from tangible_core.errors import PictureError
from tangible_core.runtime import plain_opencv

SKIN_M = 0.0005
"""The standard deviation of the Gaussian by which a fingertip blurs a relief, m."""
STEP_M, WITHIN_M = 0.0005, 0.002
"""The least height of a step that can be felt, and the distance within which it rises, m."""


def border_steps(relief: Relief, labels: Integer[np.ndarray, "h w"]) -> dict[str, float]:
    """Compare the steps of a relief that can be felt with the borders of these parts.

    A step can be felt where heights differ by 0.5 mm within 2 mm, after a Gaussian of 0.5 mm for the skin. It belongs
    to a border within 2 mm. The measures compare reliefs; they were not validated with readers.
    Returns: `borders_found`, the share of the borders' length with such a step; `steps_at_borders`, the share of the
    steps' area that is at a border; `area_stepped`, the share of the whole area that is a step. All in 0..1; NaN for a
    share of nothing.
    Raises: PictureError if the labels and the relief differ in size.
    """
    if labels.shape != relief.height_m.shape:
        raise PictureError(f"the labels are {labels.shape} and the heights {relief.height_m.shape}; scale one of them")
    steps = felt_steps(relief)
    across, along = labels[:, 1:] != labels[:, :-1], labels[1:] != labels[:-1]
    pitch_x, pitch_y = relief.pitch_m
    stepped = ((steps[:, 1:] | steps[:, :-1])[across], pitch_y), ((steps[1:] | steps[:-1])[along], pitch_x)
    length, felt_length = (sum(count(each) * side for each, side in stepped) for count in (np.size, np.count_nonzero))
    at_borders = steps & _near(labels, relief.pitch_m)
    return {
        "borders_found": _share(felt_length, length),
        "steps_at_borders": _share(np.count_nonzero(at_borders), np.count_nonzero(steps)),
        "area_stepped": _share(np.count_nonzero(steps), steps.size),
    }


def felt_steps(relief: Relief) -> Bool[np.ndarray, "h w"]:
    """Find the cells at which a step can be felt, as in `border_steps`; the rim continues at its height."""
    import cv2

    width, length = (2 * max(1, int(WITHIN_M / 2 / pitch + 1e-6)) + 1 for pitch in relief.pitch_m)
    across, along = (SKIN_M / pitch for pitch in relief.pitch_m)
    window = np.ones((length, width), np.uint8)
    with plain_opencv():
        skin = np.asarray(
            cv2.GaussianBlur(relief.height_m, (0, 0), across, sigmaY=along, borderType=cv2.BORDER_REPLICATE)
        )
        return np.asarray(cv2.dilate(skin, window)) - np.asarray(cv2.erode(skin, window)) >= np.float32(STEP_M)


def _near(labels: Integer[np.ndarray, "h w"], pitch_m: tuple[float, float]) -> Bool[np.ndarray, "h w"]:
    """Find the cells whose centres are within `WITHIN_M` of the centre of a cell at a border."""
    from scipy.ndimage import distance_transform_edt

    at_border = border_pixels(labels)
    if not at_border.any():
        return at_border
    return np.asarray(distance_transform_edt(~at_border, sampling=pitch_m[::-1])) <= WITHIN_M * (1 + 1e-6)


def _share(part: float | np.integer[Any], whole: float | np.integer[Any]) -> float:
    return float(part / whole) if whole else nan
