"""What is felt of a relief, by the true depth of its scene: borders, their order, crispness, and what a hand meets."""
# scipy has no types.
# pyright: reportMissingTypeStubs=false, reportUnknownVariableType=false

from typing import NamedTuple

import cv2
import numpy as np
from scipy.ndimage import distance_transform_edt, map_coordinates
from scipy.stats import spearmanr

from tangible_core import HapticSurface
from tangible_core.data import DisparityMap, Relief
from tangible_core.plugins.interfaces import Touch
from tangible_core.scene.geometry import nearness_range, unit_nearness
from tangible_legibility.neighbours import WITHIN_M, felt_steps

BORDER = 0.04  # the least difference of neighbours at a true border, of the range of disparities
SKIN_M = 0.0003
STEP_M, LEVEL_M, RISE_M = 0.0005, 0.00005, 0.0003
"""The least step that is felt; the least that has an order; and the least rise that is crisp or blunt."""
SAMPLES = 200_000


class Truth(NamedTuple):
    """The true nearness of a scene, 0 to 1, holes filled; where it is known; and its borders with their normals."""

    nearness: np.ndarray
    known: np.ndarray
    at_border: np.ndarray
    row: np.ndarray
    column: np.ndarray
    along: np.ndarray
    across: np.ndarray  # unit normals at the borders' pixels, towards the near side: along rows and columns


def truth_of(disparity: DisparityMap, width_m: float) -> Truth:
    """Find the borders of a true map."""
    known = np.isfinite(disparity.disparity_px)
    nearness = unit_nearness(disparity, None, nearness_range(disparity, None))
    pitch_m = width_m / nearness.shape[1]
    calm = cv2.medianBlur(nearness, 3)
    at_border = np.zeros(nearness.shape, bool)
    for here, there in ((np.s_[1:], np.s_[:-1]), (np.s_[:, 1:], np.s_[:, :-1])):
        step, both = calm[here] - calm[there], known[here] & known[there]
        at_border[here] |= (step > BORDER) & both
        at_border[there] |= (step < -BORDER) & both
    sigma = 0.0005 / pitch_m
    across, along = (cv2.GaussianBlur(cv2.Sobel(calm, cv2.CV_32F, *order), (0, 0), sigma) for order in ((1, 0), (0, 1)))
    steep = np.hypot(across, along) + 1e-9
    row, column = np.nonzero(at_border & (steep > 1e-3))
    at = (row, column)
    return Truth(nearness, known, at_border, row, column, along[at] / steep[at], across[at] / steep[at])


def felt(relief: Relief, truth: Truth) -> dict[str, float]:
    """Return what is felt: the columns of the table, all shares but `rank`."""
    pitch_m = relief.pitch_m[0]
    skin = cv2.GaussianBlur(relief.height_m, (0, 0), SKIN_M / pitch_m)

    def rise(distance_m: float) -> np.ndarray:
        far, near = (
            map_coordinates(
                skin,
                (
                    truth.row + side * distance_m / pitch_m * truth.along,
                    truth.column + side * distance_m / pitch_m * truth.across,
                ),
                order=1,
                mode="nearest",
            )
            for side in (-1, 1)
        )
        return near - far

    close, wide = rise(0.001), rise(0.004)
    clear = np.abs(wide) > RISE_M
    steps = felt_steps(relief)
    within = distance_transform_edt(~truth.at_border) * pitch_m <= WITHIN_M
    every = max(1, np.count_nonzero(truth.known) // SAMPLES)
    return {
        "found": float(np.mean(close >= STEP_M)),
        "true": float(np.mean(within[steps & truth.known])) if steps.any() else np.nan,
        "order": float(np.mean(close > LEVEL_M)),
        "wrong": float(np.mean(close < -LEVEL_M)),
        "crisp": float(np.median(np.clip(close[clear] / wide[clear], -1, 2))) if clear.any() else np.nan,
        "rank": float(spearmanr(relief.height_m[truth.known][::every], truth.nearness[truth.known][::every])[0]),
    }


def loop_work_mj(touch: Touch, surface: HapticSurface, count: int = 20, depth_m: float = 0.001) -> float:
    """Return the most work on a hand around closed loops that begin and end in free air, mJ."""
    random, time = np.random.default_rng(0), np.linspace(0, 1, 3000)
    width_m, length_m = surface.extent_m
    rows, columns = surface.height_m.shape
    free_m = float(surface.height_m.max()) + 0.003
    worst = -np.inf
    for _ in range(count):
        centre, radii = random.uniform(-0.3, 0.3, 2) * surface.extent_m, random.uniform(0.05, 0.15, 2) * width_m
        x = np.clip(centre[0] + radii[0] * np.sin(2 * np.pi * time), -0.48 * width_m, 0.48 * width_m)
        y = np.clip(centre[1] + radii[1] * np.cos(2 * np.pi * time), -0.48 * length_m, 0.48 * length_m)
        place = (0.5 - y / length_m) * rows - 0.5, (x / width_m + 0.5) * columns - 0.5
        ground_m = map_coordinates(surface.height_m, place, order=1, mode="nearest")
        inside = np.clip(np.minimum(time, 1 - time) / 0.1, 0, 1)
        path = np.column_stack([x, y, inside * (ground_m - depth_m) + (1 - inside) * free_m])
        force = touch.path(path, 0.001)
        worst = max(worst, float(np.sum((force[:-1] + force[1:]) / 2 * np.diff(path, axis=0))))
    return 1000 * worst
