"""The lines of a drawing: their centre lines, widths and dashes, without letters and specks."""
# scikit-image has no types.
# pyright: reportMissingTypeStubs=false, reportUnknownVariableType=false

from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float32

from ..runtime.opencv import cv2, plain_opencv
from .dashes import DashedLine, find_dashes
from .ink import Ink
from .tips import long_pieces


class Lines(NamedTuple):
    """Lines on the grid of the ink."""

    mask: Bool[np.ndarray, "r c"]  # the strokes themselves, and the gaps of dashed ones
    centre: Bool[np.ndarray, "r c"]  # their centre lines, one pixel wide; branches and junctions are kept
    width_px: Float32[np.ndarray, "r c"]  # the width of the ink in its middle, px; 0 elsewhere, and so in gaps
    solid: Bool[np.ndarray, "r c"]  # the centre lines without the dashed ones
    dashed: tuple[DashedLine, ...]

    def share_near(self, distance_px: float) -> float:
        """Return the share of the length of the lines that lies nearer than this to another piece of a line."""
        if not self.centre.any():
            return 0.0
        size = max(1, round(distance_px)) | 1
        disc = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (size, size))
        with plain_opencv():
            closed = np.asarray(cv2.morphologyEx(self.mask.astype(np.uint8), cv2.MORPH_CLOSE, disc)) > 0
            filled = np.asarray(cv2.dilate((closed & ~self.mask).astype(np.uint8), np.ones((3, 3)), iterations=2)) > 0
        return float((filled & self.centre).sum() / self.centre.sum())


def find_lines(ink: Ink, letters: Bool[np.ndarray, "r c"]) -> Lines:
    """Return the lines of ink without these letters and without specks, but with the dashes of dashed lines."""
    # Zhang & Suen, A fast parallel algorithm for thinning digital patterns, CACM 27, 1984.
    from skimage.morphology import skeletonize

    dashed, dashes = find_dashes(ink, letters)
    with plain_opencv():
        drawn = (ink.mask & ~letters & ~dashes).astype(np.uint8)
        drawn |= np.asarray(cv2.medianBlur(drawn, 3), np.uint8)  # fills pin holes, which would be loops
        strokes = long_pieces(drawn > 0)
        inked = strokes | dashes
        inside = np.asarray(cv2.distanceTransform(inked.astype(np.uint8), cv2.DIST_L2, 5), np.float32)
        mask, ways = inked.astype(np.uint8), np.zeros(inked.shape, np.uint8)
        for line in dashed:
            way = [np.rint(line.way).astype(np.int32)]
            cv2.polylines(mask, way, isClosed=False, color=1, thickness=max(1, round(line.width_px)))
            cv2.polylines(ways, way, isClosed=False, color=1)
    middle = np.asarray(skeletonize(inked), np.bool_)
    width = np.where(middle, np.maximum(2 * inside - 1, 1), 0).astype(np.float32)
    solid = middle & strokes
    return Lines(mask > 0, solid | (ways > 0), width, solid, dashed)
