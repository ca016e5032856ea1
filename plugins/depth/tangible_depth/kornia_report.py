"""Method `kornia-report`: the chain of `report`, its Harris response, eight-point and correlation in torch."""

from typing import TYPE_CHECKING, Annotated, ClassVar, Literal

import numpy as np
from jaxtyping import Float64, Int64
from pydantic import Field

from tangible_core.data import DisparityMap, Views
from tangible_core.plugins import DepthEstimator
from tangible_core.runtime import TorchDevice, need, pick_device

if TYPE_CHECKING:
    from .matching.feature_chain import Grey, Row
    from .sparse.matches import Matches


class KorniaReport(DepthEstimator):
    """Corners and edges, robust eight-point, rectification, correlation along rows, filling from neighbours, by kornia.

    Takes any pair, rectified or not. Matching uses grey; colour only limits the filling.
    Source: as `report`; Riba et al., Kornia, WACV 2020.
    """

    needs_pair: ClassVar[bool] = True

    window_px: Literal[5, 7, 9, 11, 13, 15, 17, 19, 21] = 9
    """Side of the square correlation window."""
    least_contrast: Annotated[float, Field(gt=0, le=1)] = 0.005
    """Gradient, as a fraction of white per pixel, below which an edge is not used as a feature."""
    least_score: Annotated[float, Field(ge=0, le=1)] = 0.7
    """Correlation below which a match is rejected."""
    max_disparity_px: Annotated[int, Field(ge=1)] | Literal["auto"] = "auto"
    """Largest disparity searched, from 0; `auto` takes the range, of either sign, from matched corners."""
    torch_device: TorchDevice = "auto"
    """Device to compute on; `auto` uses a GPU if there is one."""
    memory_mb: Annotated[int, Field(ge=1)] = 64
    """Memory for the matching scores, which are computed in strips of rows: small values suit a CPU's caches, large
    ones a GPU."""

    def estimate(self, views: Views) -> DisparityMap:
        """Estimate dense disparity of the left view. Raises: PictureError, RectificationError, BrokenMethod."""
        need("torch")
        need("kornia")
        from .matching.feature_chain import Parts, disparity_by_features

        parts = Parts(lambda grey: kornia_response(grey, self.torch_device), kornia_eight_point, self._match_rows)
        return disparity_by_features(views, parts, self.least_contrast, self.least_score, self.max_disparity_px)

    def _match_rows(
        self, left: "Grey", right: "Grey", points: Int64[np.ndarray, "n 2"], low: int, high: int
    ) -> "tuple[Row, Row]":
        from .windows.torch_zncc import match_pair

        disparity, score = match_pair(left, right, low, high, self.window_px, self.torch_device, self.memory_mb)
        columns, rows = points.T
        return disparity[rows, columns], score[rows, columns]


_BORDER = 4


def kornia_response(grey: "Grey", torch_device: TorchDevice = "auto") -> "Grey":
    """Compute `harris.harris_response` by kornia, on the same scale; the picture's edge is repeated outwards."""
    import torch
    from kornia.feature import harris_response

    # kornia mirrors at the border, which needs more rows and columns than the smallest pictures have.
    picture = torch.from_numpy(np.pad(grey, _BORDER, mode="edge")).to(pick_device(torch_device))[None, None]
    # kornia halves (-1, 0, 1), and the response is proportional to the fourth power of the slope.
    response = 16 * harris_response(picture, 0.04, grads_mode="diff")[0, 0].cpu().numpy()
    return response[_BORDER:-_BORDER, _BORDER:-_BORDER]


def kornia_eight_point(matches: "Matches", weights: np.ndarray | None = None) -> Float64[np.ndarray, "3 3"]:
    """Compute `fundamental.eight_point` by kornia, which also weights its normalisation. Raises: as `check_matches`."""
    import torch
    from kornia.geometry.epipolar import find_fundamental

    from .rectify.fundamental import check_matches

    check_matches(matches)
    left, right = (torch.from_numpy(np.asarray(points, np.float64))[None] for points in matches)
    # kornia weights squares, and its points2^T F points1 = 0 has the left picture second.
    squared_weights = None if weights is None else torch.from_numpy(np.asarray(weights, np.float64) ** 2)[None]
    matrix = find_fundamental(right, left, squared_weights)[0].numpy()
    return matrix / np.linalg.norm(matrix)
