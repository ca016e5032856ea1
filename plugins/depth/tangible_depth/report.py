"""Method `report`: the documented baseline, the chain of the report "Tangible Images"."""

from typing import TYPE_CHECKING, Annotated, ClassVar, Literal

import numpy as np
from jaxtyping import Int64
from pydantic import Field

from tangible_core.data import DisparityMap, Views
from tangible_core.plugins import DepthEstimator

if TYPE_CHECKING:
    from .matching.feature_chain import Grey, Row


class Report(DepthEstimator):
    """Harris corners and edges, robust eight-point, rectification, correlation along rows, filling from neighbours.

    Takes any pair, rectified or not. Matching uses grey; colour only limits the filling. The report measures
    disparity as the Euclidean distance of two matched points, which is the horizontal shift after rectification. It
    also proposes a Hough transform for sub-pixel accuracy, which does not provide it: a parabola through the best score
    and its neighbours is used.
    Source: Harris & Stephens 1988; Hartley 1997; Fusiello & Irsara 2011; Gastal & Oliveira 2011.
    """

    needs_pair: ClassVar[bool] = True

    window_px: Literal[5, 7, 9, 11, 13, 15, 17, 19, 21] = 9
    """Side of the square correlation window."""
    harris_sigma_px: Annotated[float, Field(gt=0, le=10)] = 1.0
    """Standard deviation of the Gaussian that weights the gradients in the Harris response."""
    least_contrast: Annotated[float, Field(gt=0, le=1)] = 0.005
    """Gradient, as a fraction of white per pixel, below which an edge is not used as a feature."""
    least_score: Annotated[float, Field(ge=0, le=1)] = 0.7
    """Correlation below which a match is rejected."""
    max_disparity_px: Annotated[int, Field(ge=1)] | Literal["auto"] = "auto"
    """Largest disparity searched, from 0; `auto` takes the range, of either sign, from matched corners."""

    def estimate(self, views: Views) -> DisparityMap:
        """Estimate dense disparity of the left view. Raises: PictureError without a right view, RectificationError."""
        from .matching.feature_chain import Parts, disparity_by_features
        from .rectify.fundamental import eight_point
        from .sparse.harris import gaussian_window, harris_response

        window = gaussian_window(self.harris_sigma_px)
        parts = Parts(lambda grey: harris_response(grey, window), eight_point, self._match_rows)
        return disparity_by_features(views, parts, self.least_contrast, self.least_score, self.max_disparity_px)

    def _match_rows(
        self, left: "Grey", right: "Grey", points: Int64[np.ndarray, "n 2"], low: int, high: int
    ) -> "tuple[Row, Row]":
        from .sparse.matches import inverse_lengths
        from .sparse.sparse_ncc import match_rows

        half = self.window_px // 2
        left_padded, right_padded = (np.pad(grey, half, mode="edge") for grey in (left, right))
        left_inverse, right_inverse = (inverse_lengths(grey, half) for grey in (left, right))
        disparity, score = np.empty(len(points), np.float32), np.empty(len(points), np.float32)
        match_rows(left_padded, right_padded, left_inverse, right_inverse, points, low, high, half, disparity, score)
        return disparity, score
