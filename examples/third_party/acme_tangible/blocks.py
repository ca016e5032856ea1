"""Depth by comparing blocks."""

from typing import Annotated, ClassVar

import numpy as np
from pydantic import Field

from tangible_core import DisparityMap, Views
from tangible_core.data import to_grey
from tangible_core.errors import PictureError
from tangible_core.plugins import DepthEstimator


class Blocks(DepthEstimator):
    """Sum of absolute differences over a square window; the winner takes all."""

    needs_pair: ClassVar[bool] = True
    window_px: Annotated[int, Field(ge=1)] = 7
    """Side of the window."""
    max_disparity_px: Annotated[int, Field(ge=1)] = 16
    """Shifts from 0 to one less than this are tried."""

    def estimate(self, views: Views) -> DisparityMap:
        """Match whole pixels; unknown where every shift fits equally, as on a wall of one colour."""
        if views.right is None:
            raise PictureError("acme-blocks compares two views; give the scene a right one, or use another method")
        left, right = to_grey(views.left), to_grey(views.right)
        costs = np.stack([self._cost(left, right, shift) for shift in range(self.max_disparity_px)])
        known = np.ptp(costs, axis=0) > 0.01
        return DisparityMap(np.where(known, costs.argmin(axis=0), np.nan).astype(np.float32))

    def _cost(self, left: np.ndarray, right: np.ndarray, shift: int) -> np.ndarray:
        import cv2  # heavy, so here: listing plugins imports this file

        columns = np.maximum(np.arange(left.shape[1]) - shift, 0)
        return cv2.blur(np.abs(left - right[:, columns]), (self.window_px, self.window_px))
