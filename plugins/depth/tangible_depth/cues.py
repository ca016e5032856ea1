"""Depth of one photograph by where things stand: lower is nearer."""

import logging
from pathlib import Path
from typing import ClassVar

import numpy as np
from jaxtyping import Float32, Float64, Int32

from tangible_core.data import DisparityMap, Views, to_rgb
from tangible_core.drawing import PictureKind, noise_level, picture_kind
from tangible_core.errors import PictureError
from tangible_core.plugins import DepthEstimator, note
from tangible_core.runtime import cv2, plain_opencv

log: logging.Logger = logging.getLogger(__name__)
CELLS = 40_000  # largest number of cells on which regions are found
# Options of the regions: preference for large ones, standard deviation of the blur, and fewest cells of one.
SCALE, SIGMA, MIN_CELLS = 400, 0.8, 80
BOTTOM, MIDDLE, OWN_ROW = 1.0, 0.25, 1.0
"""Weights of the lowest row of a pixel's region, of the mean row of its region, and of its own row."""
# Weights of the figure's map, if there is a network for it: of a pixel, and of the mean of its region.
FIGURE, FIGURE_REGION = 0.2, 0.2
# Probability that an order is right: 1 / (1 + exp(-STEEPNESS |difference of scores|)), fitted to four scenes.
STEEPNESS = 2.6
# Largest share of the lower rim that a figure may cover: of a portrait no ground is seen.
MAX_RIM = 0.75
# Largest share of the picture of about one colour: more is paper, and no ground.
GROUND_CELLS = 14_000
"""Largest number of cells on which a plain ground is looked for."""
SMOOTH, NOISE = 0.05, 3.0
"""Largest difference of a colour within 3 x 3 cells of a plain ground, beyond so many standard deviations of noise."""
MAX_GROUND = 0.45
"""Largest share of the picture that may be one plain ground, seen at all four rims: more is paper, or a table."""


class Cues(DepthEstimator):
    """Lower is nearer: where each region stands on the ground, and what stands out from it; for one photograph.

    A score is the weighted sum of the lowest and the mean row of a pixel's region, of its own row, and of the map of
    the figure where there is a network for it (`tangible networks add figure`). The confidence of a pixel is how surely
    it is nearer or farther than the others. A picture without a ground is refused: a portrait, a drawing, a page, or
    things from above, which a plain ground surrounds.

    Sources: Felzenszwalb & Huttenlocher, Efficient graph-based image segmentation, IJCV 59, 2004 (regions); Hoiem,
    Efros & Hebert, Geometric context from a single image, ICCV 2005 (where regions stand).
    """

    finds_depth: ClassVar[bool] = True

    def reads(self) -> tuple[Path, ...]:
        """Return the network of figures, if there is one."""
        from tangible_networks.store import networks_here

        return tuple(network.path for network in networks_here("figure")[:1])

    def estimate(self, views: Views) -> DisparityMap:
        """Estimate relative nearness in 0..1, known everywhere. Raises: PictureError for a picture without a ground."""
        from tangible_networks.seeing import look_for_figure

        colours = to_rgb(views.left)
        if _has_plain_ground(colours) or picture_kind(views.left).likely != PictureKind.photograph:
            raise PictureError(
                "the picture is drawn or written, or shows things from above on a plain ground, as coins on a table, "
                "so that what stands lower in it is no nearer; use `relief: edges`, or parts with heights"
            )
        figure = look_for_figure(colours)
        if figure is not None and float((figure[-1] > 0.5).mean()) > MAX_RIM:
            raise PictureError(
                "the figure reaches the lower rim of the picture, as in a portrait, so that no ground is seen; "
                "use `relief: figure`"
            )
        if figure is None:
            note(log, "by rows alone: a network of figures makes it better (`tangible networks add figure`)")
        score = score_nearness(_regions(colours), figure)
        low, high = float(score.min()), float(score.max())
        nearness = (score - low) / (high - low) if high > low else np.zeros_like(score)
        return DisparityMap(nearness.astype(np.float32), _confidence(score), unit="relative")


def score_nearness(
    regions: Int32[np.ndarray, "h w"], figure: Float32[np.ndarray, "h w"] | None
) -> Float64[np.ndarray, "h w"]:
    """Return the score of each pixel, larger for nearer. figure: 0..1, None without a network."""
    rows, columns = regions.shape
    row = np.repeat(np.arange(rows)[:, None] / max(rows, 1), columns, axis=1)
    counts = np.bincount(regions.ravel())
    lowest = np.zeros(len(counts))
    np.maximum.at(lowest, regions.ravel(), row.ravel())
    mean = np.bincount(regions.ravel(), row.ravel()) / np.maximum(counts, 1)
    score = BOTTOM * lowest[regions] + MIDDLE * mean[regions] + OWN_ROW * row
    if figure is None:
        return score
    share = np.bincount(regions.ravel(), figure.ravel().astype(np.float64)) / np.maximum(counts, 1)
    return score + FIGURE * figure + FIGURE_REGION * share[regions]


def order_probability(difference: Float64[np.ndarray, "..."]) -> Float64[np.ndarray, "..."]:
    """Return how probably the order of two pixels is right whose scores differ by this much.

    >>> order_probability(np.array([0.0, 1.0])).round(2).tolist()
    [0.5, 0.93]
    """
    return 1 / (1 + np.exp(-STEEPNESS * np.abs(difference)))


def _confidence(score: Float64[np.ndarray, "h w"]) -> Float32[np.ndarray, "h w"]:
    """Return how surely a pixel's order with the others is known, 0..1, by the deciles of the scores."""
    deciles = np.quantile(score, np.arange(0.05, 1, 0.1))
    sure = sum(2 * order_probability(score - decile) - 1 for decile in deciles)
    return np.asarray(sure / len(deciles), np.float32)


def _regions(colours: Float32[np.ndarray, "h w 3"]) -> Int32[np.ndarray, "h w"]:
    from skimage.segmentation import felzenszwalb

    with plain_opencv():
        small = _reduce(colours, CELLS)
        labels = felzenszwalb(small, scale=SCALE, sigma=SIGMA, min_size=MIN_CELLS)
        return cv2.resize(labels.astype(np.int32), colours.shape[1::-1], interpolation=cv2.INTER_NEAREST)


def _has_plain_ground(colours: Float32[np.ndarray, "h w 3"]) -> bool:
    """Return True if a smooth ground of more than MAX_GROUND reaches all four rims of the picture."""
    with plain_opencv():
        small, near = _reduce(colours, GROUND_CELLS), np.ones((3, 3), np.uint8)
        change = (cv2.dilate(small, near) - cv2.erode(small, near)).reshape(small.shape).max(axis=2)
        smooth = change < SMOOTH + NOISE / 255 * noise_level((255 * small).astype(np.uint8))
        _, grounds = cv2.connectedComponents(smooth.astype(np.uint8), connectivity=4)
    rims = grounds[0], grounds[-1], grounds[:, 0], grounds[:, -1]
    around = set.intersection(*(set(rim.tolist()) for rim in rims)) - {0}
    return any((grounds == ground).mean() > MAX_GROUND for ground in around)


def _reduce(colours: Float32[np.ndarray, "h w 3"], cells: int) -> Float32[np.ndarray, "r c 3"]:
    rows, columns = colours.shape[:2]
    scale = min(1.0, (cells / (rows * columns)) ** 0.5)
    size = max(1, round(columns * scale)), max(1, round(rows * scale))
    return np.asarray(cv2.resize(colours, size, interpolation=cv2.INTER_AREA))
