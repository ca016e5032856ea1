"""Method `contour`: relief from one picture, its edges kept, its shading and texture levelled."""

from typing import Annotated, ClassVar

import numpy as np
from jaxtyping import Bool, Float, Float32
from pydantic import Field

from tangible_core.data import DisparityMap, Views, to_grey
from tangible_core.plugins import DepthEstimator
from tangible_core.runtime import plain_opencv


def gradient(
    heights: Float[np.ndarray, "h w"],
) -> tuple[Float[np.ndarray, "h w"], Float[np.ndarray, "h w"]]:
    """Return the differences to the next column and to the next row; 0 in the last one, which has no next."""
    return np.diff(heights, axis=1, append=heights[:, -1:]), np.diff(heights, axis=0, append=heights[-1:])


def integrate(x_slope: Float[np.ndarray, "h w"], y_slope: Float[np.ndarray, "h w"]) -> Float[np.ndarray, "h w"]:
    """Return the surface (h, w) of mean zero whose `gradient` is nearest to these slopes by least squares."""
    from scipy.fft import dctn, idctn

    # The Poisson equation with free borders by the cosine transform: Frankot & Chellappa, PAMI 1988, on the basis of
    # Simchony, Chellappa & Shao, PAMI 1990. The last column of x_slope and the last row of y_slope are not read.
    rows, columns = x_slope.shape
    x = np.concatenate(
        [np.zeros((rows, 1), x_slope.dtype), x_slope[:, :-1], np.zeros((rows, 1), x_slope.dtype)], axis=1
    )
    y = np.concatenate([np.zeros((1, columns), y_slope.dtype), y_slope[:-1], np.zeros((1, columns), y_slope.dtype)])
    spectrum = dctn(np.diff(x, axis=1) + np.diff(y, axis=0), type=2)
    along_y = 2 * np.cos(np.pi * np.arange(rows) / rows)[:, None] - 2
    along_x = 2 * np.cos(np.pi * np.arange(columns) / columns) - 2
    eigenvalue = (along_y + along_x).astype(x_slope.dtype)
    eigenvalue[0, 0] = 1
    spectrum /= eigenvalue
    spectrum[0, 0] = 0
    return np.asarray(idctn(spectrum, type=2))


class Contour(DepthEstimator):
    """Slopes along contours are kept, all others flattened, and a surface is fitted to them; lighter is nearer.

    The picture is converted to grey.

    A contour is found as Canny finds edges, by two thresholds on the slope, but in its full width, so that each step
    of the relief has the height of the picture's step.
    Source: the role of contours is that of Vasudevan & Manivannan, Tangible Images, 2008; the integration that of
    Frankot & Chellappa, PAMI 1988.
    """

    finds_depth: ClassVar[bool] = False

    smoothing_px: Annotated[float, Field(ge=0, le=20)] = 1.0
    """Standard deviation of the Gaussian that removes noise first; 0 for none."""
    strong_edge: Annotated[float, Field(gt=0, le=1)] = 0.2
    """Gradient, as a fraction of the picture's steepest, above which a contour starts."""
    weak_edge: Annotated[float, Field(ge=0, le=1)] = 0.05
    """Gradient, as a fraction of the picture's steepest, down to which a contour is followed; 0 keeps every
    gradient."""
    least_contrast: Annotated[float, Field(gt=0, le=1)] = 0.004
    """Smallest gradient of a contour, as a fraction of white per pixel, so that a flat picture stays flat."""

    def estimate(self, views: Views) -> DisparityMap:
        """Estimate relative nearness of the left view, 0 far to 1 near; all 0 without a contour. The right is ignored.

        Confidence is 1 where the relief has the slope of the contours, less where they contradict each other.
        """
        import cv2

        grey = to_grey(views.left)
        if self.smoothing_px > 0:
            with plain_opencv():
                grey = cv2.GaussianBlur(grey, (0, 0), self.smoothing_px, borderType=cv2.BORDER_REFLECT)
        x, y = gradient(grey)
        steepness = np.hypot(x, y)
        on_contour = self._contours(steepness)
        x, y = np.where(on_contour, x, 0), np.where(on_contour, y, 0)
        relief = integrate(x, y)
        relief_x, relief_y = gradient(relief)
        error = np.hypot(relief_x - x, relief_y - y) / max(float(steepness.max()), self.least_contrast)
        height = float(np.ptp(relief))
        # A smaller height is rounding error of float32.
        nearness = (relief - relief.min()) / height if height > 1e-6 else np.zeros_like(relief)
        return DisparityMap(nearness.astype(np.float32), (1 / (1 + 10 * error)).astype(np.float32), "relative")

    def _contours(self, steepness: Float32[np.ndarray, "h w"]) -> Bool[np.ndarray, "h w"]:
        """Find pixels over the weak threshold that are connected to one over the strong (Canny 1986, sec. 5.2)."""
        import cv2

        steepest = float(steepness.max())
        strong = steepness >= max(self.strong_edge * steepest, self.least_contrast)
        weak = (steepness > self.weak_edge * steepest) | strong
        _, label = cv2.connectedComponents(weak.astype(np.uint8), connectivity=8)
        label = np.asarray(label, np.intp)
        contour = np.bincount(label[strong], minlength=int(label.max()) + 1) > 0
        return weak & contour[label]
