"""Pairs whose right camera rolled and tilted: rectified, matched, and brought back."""

from functools import partial
from typing import NamedTuple

import cv2
import numpy as np

from tangible_core.data import Views
from tangible_core.metrics import disparity_errors
from tangible_depth.rectify.homographies import camera_matrix, rotation, transform
from tangible_depth.rectify.rectification import rectify
from tangible_depth.rectify.rectified import RectifiedPair
from tangible_depth.semi_global import SemiGlobal

from .depth_pairs import KnownScene, real, synthetic
from .figures import Figure

ROLL_DEGREES, TILT = 2.0, (2e-5, -3e-5)
"""Of the right picture about its middle; perspective in 1/px."""


class Rolled(NamedTuple):
    """A pair whose right view was rolled by `homography`, and what can be asked of it."""

    views: Views
    homography: np.ndarray
    truth_px: np.ndarray
    """NaN also where the match has left the right picture."""


def figures() -> list[Figure]:
    """Offset of the rows and loss in error, on every pair."""
    offsets, losses = {}, {}
    for name, scene in {**real(), **synthetic()}.items():
        rolled = roll(scene)
        rectified = rectify(rolled.views)
        offsets[name] = offset(scene, rolled, rectified)
        losses[name] = loss(scene, rolled, rectified)
    worst, furthest = max(offsets, key=offsets.__getitem__), max(losses, key=losses.__getitem__)
    measured = (
        f"offset {offsets[worst]:.3f} px at most ({worst}; motorcycle {offsets['motorcycle']:.3f}); bad2 "
        f"{losses[furthest]:+.2f} points at most ({furthest}; motorcycle {losses['motorcycle']:+.2f}, "
        f"mean {np.mean(list(losses.values())):+.2f})"
    )
    return [
        Figure(
            f"unrectified: right view rolled {ROLL_DEGREES:g} degrees, with perspective; `semi-global`",
            "median vertical offset <= 0.12 px, bad2 within 1 point of the rectified pair",
            measured,
            offsets[worst] <= 0.12 and losses[furthest] <= 1,
        )
    ]


def roll(scene: KnownScene) -> Rolled:
    """The right view as a camera that rolled and tilted would show it."""
    h, w = scene.grey.right.shape
    middle = camera_matrix(1, (h, w))
    turned = rotation(0, 0, np.radians(ROLL_DEGREES))
    turned[2, :2] = TILT
    homography = middle @ turned @ np.linalg.inv(middle)
    right = cv2.warpPerspective(
        scene.grey.right, homography, (w, h), flags=cv2.INTER_CUBIC, borderMode=cv2.BORDER_REPLICATE
    )
    x, y = transform(homography, _matches(scene)).T
    inside = ((x >= 0) & (x <= w - 1) & (y >= 0) & (y <= h - 1)).reshape(h, w)
    return Rolled(Views(scene.grey.left, right), homography, np.where(inside, scene.pair.truth_px, np.float32(np.nan)))


def _matches(scene: KnownScene) -> np.ndarray:
    """Where the unrolled right view shows each left pixel, (n, 2); NaN without truth."""
    rows, columns = np.indices(scene.grey.left.shape, np.float64)
    return np.column_stack([(columns - scene.pair.truth_px).ravel(), rows.ravel()])


def offset(scene: KnownScene, rolled: Rolled, rectified: RectifiedPair) -> float:
    """Median of |row in the right view - row in the left one| of the true matches, after rectification."""
    rows, columns = np.indices(scene.grey.left.shape, np.float64)
    left = transform(rectified.left_homography, np.column_stack([columns.ravel(), rows.ravel()]))
    right = transform(rectified.right_homography, transform(rolled.homography, _matches(scene)))
    asked = (np.isfinite(rolled.truth_px) & scene.pair.visible).ravel()
    return float(np.median(np.abs(left[asked, 1] - right[asked, 1])))


def loss(scene: KnownScene, rolled: Rolled, rectified: RectifiedPair) -> float:
    """bad2 of the rolled pair less that of the pair as it was, over the same pixels, in points.

    What is found is followed to its place in the rolled right picture and from there back to the unrolled one, so
    that it is a disparity like the true one.
    """
    found = rectified.to_original(SemiGlobal().estimate(rectified.views)).disparity_px
    place = transform(np.linalg.inv(rolled.homography), rectified.right_px(found).reshape(-1, 2))
    columns = np.indices(found.shape, np.float64)[1]
    again = columns - place[:, 0].reshape(found.shape)
    before = SemiGlobal().estimate(scene.views).disparity_px
    bad = partial(disparity_errors, truth_px=rolled.truth_px)
    return bad(again)["bad2"] - bad(before)["bad2"]
