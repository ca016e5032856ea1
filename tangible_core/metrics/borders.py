"""How well the borders between a picture's parts are felt: as steps under a fingertip that sinks in a little."""
# scipy has no types.
# pyright: reportMissingTypeStubs=false, reportUnknownVariableType=false

from math import nan
from typing import Any

import numpy as np
from jaxtyping import Bool

from ..data import Relief
from ..data.views import border_pixels
from ..errors import PictureError
from ..runtime.opencv import plain_opencv
from .segments import Labels

SKIN_M = 0.0005
"""Standard deviation of the Gaussian by which a fingertip blurs what it touches."""
STEP_M, WITHIN_M = 0.0005, 0.002
"""A step that is felt: so high, within so far."""


def border_steps(relief: Relief, labels: Labels) -> dict[str, float]:
    """Of the steps that are felt in a relief, how many are borders of these parts, and of the borders, how many.

    A step is felt where heights differ by 0.5 mm within 2 mm, after a Gaussian of 0.5 mm for the skin. It is one of a
    border that lies no further than 2 mm from it. No reader was asked; the numbers compare reliefs, not people.
    Returns: `borders_found`, the share of the borders' length with a felt step; `steps_at_borders`, the share of the
    felt area that is at a border; `area_stepped`, the share of the whole area that is felt as a step. All in 0..1; NaN
    for a share of nothing.
    Raises: PictureError if the labels and the relief differ in size.
    """
    if labels.shape != relief.height_m.shape:
        raise PictureError(f"the labels are {labels.shape} and the heights {relief.height_m.shape}; scale one of them")
    felt = felt_steps(relief)
    across, along = labels[:, 1:] != labels[:, :-1], labels[1:] != labels[:-1]
    pitch_x, pitch_y = relief.pitch_m
    on_felt = ((felt[:, 1:] | felt[:, :-1])[across], pitch_y), ((felt[1:] | felt[:-1])[along], pitch_x)
    length, found = (sum(count(each) * side for each, side in on_felt) for count in (np.size, np.count_nonzero))
    at_borders = felt & _near(labels, relief.pitch_m)
    return {
        "borders_found": _share(found, length),
        "steps_at_borders": _share(np.count_nonzero(at_borders), np.count_nonzero(felt)),
        "area_stepped": _share(np.count_nonzero(felt), felt.size),
    }


def felt_steps(relief: Relief) -> Bool[np.ndarray, "h w"]:
    """Where a step is felt: see `border_steps`. What lies beyond the rim is as high as the rim."""
    import cv2

    width, length = (2 * max(1, int(WITHIN_M / 2 / pitch + 1e-6)) + 1 for pitch in relief.pitch_m)
    across, along = (SKIN_M / pitch for pitch in relief.pitch_m)
    window = np.ones((length, width), np.uint8)
    with plain_opencv():
        skin = np.asarray(
            cv2.GaussianBlur(relief.height_m, (0, 0), across, sigmaY=along, borderType=cv2.BORDER_REPLICATE)
        )
        return np.asarray(cv2.dilate(skin, window)) - np.asarray(cv2.erode(skin, window)) >= np.float32(STEP_M)


def _near(labels: Labels, pitch_m: tuple[float, float]) -> Bool[np.ndarray, "h w"]:
    """The cells whose centre is no further than `WITHIN_M` from that of a cell beside a border."""
    from scipy.ndimage import distance_transform_edt

    beside = border_pixels(labels)
    if not beside.any():
        return beside
    return np.asarray(distance_transform_edt(~beside, sampling=pitch_m[::-1])) <= WITHIN_M * (1 + 1e-6)


def _share(part: float | np.integer[Any], whole: float | np.integer[Any]) -> float:
    return float(part / whole) if whole else nan
