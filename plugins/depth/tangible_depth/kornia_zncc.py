"""Method `kornia-zncc`: dense normalised cross-correlation in torch."""

from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import Field

from tangible_core.data import DisparityMap, Views, to_grey
from tangible_core.errors import PictureError
from tangible_core.plugins import DepthEstimator
from tangible_core.runtime import TorchDevice, need


class KorniaZNCC(DepthEstimator):
    """Zero-mean normalised cross-correlation of every pixel, parabola, left-right check, holes filled by colour.

    Matching uses grey; colour only limits the filling.

    Its functions (`torch_zncc`) accept batches and provide gradients; this method takes one pair.
    """

    needs_pair: ClassVar[bool] = True

    window_px: Literal[3, 5, 7, 9, 11, 13, 15] = 7
    """Side of the square correlation window."""
    max_disparity_px: Annotated[int, Field(ge=1)] | Literal["auto"] = "auto"
    """Largest disparity searched, from 0; `auto` takes the range, of either sign, from matched corners."""
    rectify: Literal["auto", "never"] = "auto"
    """`auto` rectifies a pair whose rows do not correspond; `never` takes every pair as rectified."""
    torch_device: TorchDevice = "auto"
    """Device to compute on; `auto` uses a GPU if there is one."""
    memory_mb: Annotated[int, Field(ge=1)] = 64
    """Memory for the matching scores, which are computed in strips of rows: small values suit a CPU's caches, large
    ones a GPU."""

    def estimate(self, views: Views) -> DisparityMap:
        """Estimate dense disparity of the left view. Raises: PictureError, RectificationError, BrokenMethod."""
        need("torch")
        from .rectify.rectification import estimate_rectified

        if views.right is None:
            raise PictureError("kornia-zncc needs two views; give a right one")
        return self._match(views) if self.rectify == "never" else estimate_rectified(views, self._match)

    def _match(self, views: Views) -> DisparityMap:
        from .sparse.assembling import assemble, erase_speckles
        from .sparse.corner_range import range_of_pair
        from .windows.torch_zncc import match_pair

        assert views.right is not None
        left, right = to_grey(views.left), to_grey(views.right)
        low, high = range_of_pair(left, right, self.max_disparity_px)
        disparity, score = match_pair(left, right, low, high, self.window_px, self.torch_device, self.memory_mb)
        disparity = erase_speckles(disparity)
        dense = assemble(disparity, score, views.left)
        valid_mask = np.isfinite(disparity)
        return DisparityMap(
            np.where(valid_mask, disparity, dense.disparity_px), np.where(valid_mask, score, dense.confidence)
        )
