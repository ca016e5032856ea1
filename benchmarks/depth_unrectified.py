"""Pairs whose right camera rolled and tilted: rectified, matched, and brought back."""

from functools import partial
from typing import NamedTuple

import cv2
import numpy as np

from tangible_core.data import Views
from tangible_core.metrics import disparity_errors
from tangible_depth.rectify.homographies import camera_matrix, rotation, transform
from tangible_depth.rectify.rectification import rectify
from tangible_depth.rectify.rectified_pair import RectifiedPair, warp_pair
from tangible_depth.semi_global import SemiGlobal

from .depth_pairs import KnownScene, real, synthetic
from .figures import Figure

ROLL_DEGREES, TILT = 2.0, (2e-5, -3e-5)
"""Of the right picture about its middle; perspective in 1/px."""

MOST_CHANGE = 0.08
"""Difference of the views, white being 1, above which they do not show the same."""


class Rolled(NamedTuple):
    """A pair whose right view was rolled by `homography`, and what can be asked of it."""

    views: Views
    homography: np.ndarray
    truth_px: np.ndarray
    """NaN also where the match has left the right picture."""


def figures() -> list[Figure]:
    """Offset of the rows and loss in error, on every pair."""
    offsets, as_given, own, losses, floors = {}, {}, {}, {}, {}
    for name, scene in {**real(), **synthetic()}.items():
        rolled = roll(scene)
        rectified = rectify(rolled.views)
        row_offsets, own[name] = row_offsets_px(scene, rolled, rectified), own_row_offset_px(scene)
        offsets[name] = float(np.median(np.abs(row_offsets - own[name])))
        as_given[name] = float(np.median(np.abs(row_offsets)))
        losses[name] = loss(scene, rolled, rectified)
        floors[name] = loss(scene, rolled, undone(rolled))
    worst, apart, furthest, floor = (max(each, key=each.__getitem__) for each in (offsets, as_given, losses, floors))
    measured = (
        f"offset {offsets[worst]:.3f} px at most ({worst}; motorcycle {offsets['motorcycle']:.3f}) from the rows on "
        f"which a pair shows the same, {as_given[apart]:.3f} px from rows of equal number ({apart}, whose own lie "
        f"{abs(own[apart]):.3f} px apart as given); bad2 {losses[furthest]:+.2f} points at most ({furthest}; "
        f"motorcycle {losses['motorcycle']:+.2f}, mean {np.mean(list(losses.values())):+.2f}); with the roll undone "
        f"exactly {floors[floor]:+.2f} at most ({floor}; mean {np.mean(list(floors.values())):+.2f})"
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
    """Return the right view as a camera that rolled and tilted would show it."""
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


def row_offsets_px(scene: KnownScene, rolled: Rolled, rectified: RectifiedPair) -> np.ndarray:
    """Row in the left view - row in the right one of the true matches, after rectification, (n,)."""
    rows, columns = np.indices(scene.grey.left.shape, np.float64)
    left = transform(rectified.left_homography, np.column_stack([columns.ravel(), rows.ravel()]))
    right = transform(rectified.right_homography, transform(rolled.homography, _matches(scene)))
    asked = (np.isfinite(rolled.truth_px) & scene.pair.visible).ravel()
    return left[asked, 1] - right[asked, 1]


def own_row_offset_px(scene: KnownScene) -> float:
    """By how much the right view of a pair as given shows things lower than the left one.

    Photographs that are called rectified may miss by a tenth of a pixel and more, and what aligns their contents then
    misses the rows that are taken for true. Least squares of what is left between the views where the true disparity
    is taken out, apart from slow changes of brightness, against the slopes of the left one.
    Source: Lucas & Kanade, An Iterative Image Registration Technique, IJCAI 1981, over the whole picture.
    """
    left, right = (each.astype(np.float32) / 255 for each in scene.grey)
    rows, columns = np.indices(left.shape, np.float32)
    known = np.isfinite(scene.pair.truth_px) & scene.pair.visible
    source = columns - np.where(known, scene.pair.truth_px, np.float32(0))
    slopes = np.stack([cv2.Scharr(left, -1, *along) / 32 for along in ((1, 0), (0, 1))], axis=2)
    moved = np.zeros(2)
    for _ in range(4):
        shown = cv2.remap(
            right,
            source + np.float32(moved[0]),
            rows + np.float32(moved[1]),
            cv2.INTER_CUBIC,
            borderMode=cv2.BORDER_REPLICATE,
        )
        change = shown - left
        change -= cv2.GaussianBlur(change, (0, 0), 8)
        right_places = known & (np.abs(change) < MOST_CHANGE)
        moved = moved - np.linalg.lstsq(slopes[right_places], change[right_places])[0]
    return float(moved[1])


def undone(rolled: Rolled) -> RectifiedPair:
    """Return the pair rectified by what rolled it: whatever is lost then, no better geometry brings back."""
    return warp_pair(rolled.views, (np.eye(3), np.linalg.inv(rolled.homography)), "the roll undone")


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
