"""Notes on parts of a plate that a printer cannot print well."""

import logging
from math import ceil

import cv2
import numpy as np

from tangible_core.data import Relief
from tangible_core.plugins import note
from tangible_core.runtime import plain_opencv

log: logging.Logger = logging.getLogger(__name__)

THIN_BASE_M = 0.0008
"""Thinnest base that neither bends nor breaks; 0.0015 is better (Round Table, Guidelines for producing accessible 3D
prints)."""
LARGEST_BED_M = 0.25
"""Bed of most printers for homes and schools. A convention of ours."""
NOZZLE_M, LAYER_M = 0.0004, 0.00015
"""Nozzle and layer of most printers. A convention of ours."""
LEAST_AREA_M2, LEAST_SHARE = 2.5e-7, 0.001
"""Smallest area of thin shapes and smallest share of steep pixels that are reported."""
STEEPEST_DEG = 45
"""Largest overhang, from the upright, that plastic holds without support."""
ROWS_AT_ONCE = 256
"""Rows that are checked at a time, to save memory."""


def note_print_problems(picture: Relief, size_m: tuple[float, float], base_m: float) -> None:
    """Note shapes that are too thin, too large or too steep to print.

    size_m: width and length of the whole plate.
    """
    if base_m < THIN_BASE_M:
        fault = f"a base of {1000 * base_m:.2g} mm bends and breaks"
        note(log, f"{fault}; make base_m {1000 * THIN_BASE_M:.1g} mm or more, better 1.5 mm", logging.WARNING)
    if (side_m := max(size_m)) > LARGEST_BED_M:
        fault = f"the plate is {1000 * side_m:.0f} mm long, more than the bed of most printers has room for"
        note(log, f"{fault}; for {1000 * LARGEST_BED_M:.0f} mm, make longer_side_m or rim_m smaller", logging.WARNING)
    _note_thin(picture)
    _note_steep(picture)


def _note_thin(picture: Relief) -> None:
    """Note shapes that an opening with a disc of a nozzle's size removes."""
    heights = picture.height_m
    size = tuple(max(1, ceil(NOZZLE_M / pitch - 1e-6)) for pitch in picture.pitch_m)
    middle = tuple((side - 1) // 2 for side in size)
    back = tuple(side - 1 - at for side, at in zip(size, middle, strict=True))  # an even side has no middle
    with plain_opencv():
        kernel = cv2.getStructuringElement(cv2.MORPH_ELLIPSE if min(size) > 2 else cv2.MORPH_RECT, size)
        lost_m = heights - cv2.dilate(cv2.erode(heights, kernel, anchor=middle), kernel, anchor=back)
    area_m2 = np.count_nonzero(lost_m > LAYER_M) * picture.pitch_m[0] * picture.pitch_m[1]
    if area_m2 < LEAST_AREA_M2:
        return
    fault = f"the printer may leave out shapes thinner than a nozzle of {1000 * NOZZLE_M:.1g} mm"
    where = f"{1e6 * area_m2:,.1f} square mm of the picture, up to {1000 * lost_m.max():.2g} mm high"
    note(log, f"{fault}: {where}; smooth the relief with workspace.smooth_m, or print it larger", logging.WARNING)


def _note_steep(picture: Relief) -> None:
    """Note steep slopes: they overhang when the plate is printed standing up, never when it lies flat."""
    heights = picture.height_m
    rows, columns = heights.shape
    limit = float(np.tan(np.radians(STEEPEST_DEG)))
    steep = 0
    for first in range(0, rows - 1, ROWS_AT_ONCE):
        strip = heights[first : first + ROWS_AT_ONCE + 1]
        right = np.diff(strip, axis=1)[:-1] / picture.pitch_m[0]
        down = np.diff(strip, axis=0)[:, :-1] / picture.pitch_m[1]
        steep += np.count_nonzero(np.hypot(right, down) > limit)
    share = steep / max(1, (rows - 1) * (columns - 1))
    if share >= LEAST_SHARE:
        fault = f"{100 * share:.2g} % of the picture is steeper than {STEEPEST_DEG} degrees"
        note(log, f"{fault}: print the plate lying flat; standing up, it would need supports there")
