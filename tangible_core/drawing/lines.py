"""The lines of a drawing: their centre lines and widths, without letters and specks."""
# scikit-image has no types.
# pyright: reportMissingTypeStubs=false, reportUnknownVariableType=false

from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float32

from ..runtime.opencv import plain_opencv
from .ink import Ink

# The least length of a line, as a share of the longer side; what is shorter is a speck.
MIN_LONG = 1 / 60


class Lines(NamedTuple):
    """Lines on the grid of the ink."""

    mask: Bool[np.ndarray, "r c"]  # the strokes themselves
    centre: Bool[np.ndarray, "r c"]  # their centre lines, one pixel wide; branches and junctions are kept
    width_px: Float32[np.ndarray, "r c"]  # the width of the stroke at its centre line, px; 0 elsewhere

    def share_near(self, distance_px: float) -> float:
        """Return the share of the length of the lines that lies nearer than this to another piece of a line."""
        import cv2

        if not self.centre.any():
            return 0.0
        size = max(1, round(distance_px)) | 1
        disc = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (size, size))
        with plain_opencv():
            closed = np.asarray(cv2.morphologyEx(self.mask.astype(np.uint8), cv2.MORPH_CLOSE, disc)) > 0
            filled = np.asarray(cv2.dilate((closed & ~self.mask).astype(np.uint8), np.ones((3, 3)), iterations=2)) > 0
        return float((filled & self.centre).sum() / self.centre.sum())


def find_lines(ink: Ink, letters: Bool[np.ndarray, "r c"]) -> Lines:
    """Return the lines of ink without these letters and without specks."""
    # Zhang & Suen, A fast parallel algorithm for thinning digital patterns, CACM 27, 1984.
    import cv2
    from skimage.morphology import skeletonize

    with plain_opencv():
        drawn = (ink.mask & ~letters).astype(np.uint8)
        drawn |= np.asarray(cv2.medianBlur(drawn, 3), np.uint8)  # fills pin holes, which would be loops
        _, pieces, about, _ = cv2.connectedComponentsWithStats(drawn, connectivity=8)
        sides = np.asarray(about, np.float64)[:, [cv2.CC_STAT_WIDTH, cv2.CC_STAT_HEIGHT]]
        long = np.hypot(sides[:, 0], sides[:, 1]) >= MIN_LONG * max(ink.mask.shape)
        long[0] = False
        mask = long[np.asarray(pieces, np.int32)]
        inside = np.asarray(cv2.distanceTransform(mask.astype(np.uint8), cv2.DIST_L2, 5), np.float32)
    centre = np.asarray(skeletonize(mask), np.bool_)
    return Lines(mask, centre, np.where(centre, np.maximum(2 * inside - 1, 1), 0).astype(np.float32))
