"""Segments by gradient: flat basins, flooded up to the edges between them."""

import logging
from typing import TYPE_CHECKING, Annotated, Literal, Self

import numpy as np
from jaxtyping import Float32, Int32
from pydantic import Field, model_validator

from tangible_core.data import SegmentMap
from tangible_core.plugins import note

from .signal.skipping import Dividing, one_segment

if TYPE_CHECKING:
    from .regions.borders import Landscape

log: logging.Logger = logging.getLogger(__name__)

NOTHING = 1e-6
"""The largest slope per pixel that rounding can produce in a picture of one colour, when white is 1."""


class Gradient(Dividing):
    """Regions between edges: a watershed of the gradient and Canny edges; for smooth things rather than textures.

    The picture is smoothed; the slope is that of its steepest channel, in units of the local noise. Connected flat
    areas are the first segments. They grow uphill until they meet (a watershed), and two of them stay separate if three
    fifths or more of their border lie on edges: on Canny's, or where the picture rises from one to the other with two
    thirds of the slope that starts an edge. All of this happens at 1.75 sigma_px, which weak edges need, on a grid as
    coarse as that allows; then the boundaries are flooded once more, at sigma_px and to the pixel. Labels are in the
    order of their first pixels, row by row. Confidence is 1 - (s - flat) / (top - flat) within 0..1, where s is the
    slope in units of noise and top the larger of its maximum and canny_high: 1 in a flat basin, 0 on the strongest
    edge.
    Memory: 40 bytes a pixel beyond the picture for grey, 75 for colour.
    Sources: Canny, A computational approach to edge detection, 1986; Meyer, Un algorithme optimal pour la ligne de
    partage des eaux, 1991.
    """

    segments: Annotated[int, Field(ge=1)] | Literal["auto"] = "auto"
    """Largest number of segments: the least separated ones are merged; `auto`: as many as edges separate, at most 64,
    reported with the share of edges in the weakest border."""
    sigma_px: Annotated[float, Field(gt=0, le=100)] = 2.0
    """Standard deviation of the smoothing Gaussian, limited to 1/16 of the square root of the picture's area. A region
    narrower than about 8 of these can be lost: less for small things, more for weak edges in noise."""
    smallest_px: Annotated[int, Field(ge=1)] = 100
    """Smallest flat area that starts a segment; limited to 1/16 of a small picture's area, and never under 4."""
    flat: Annotated[float, Field(gt=0, le=20)] = 1.4
    """Largest gradient that counts as flat, as a multiple of the noise; where there is no flat part, 4 or 16 times as
    much."""
    canny_low: Annotated[float, Field(gt=0, le=20)] = 2.0
    """Lower Canny threshold, as a multiple of the noise gradient: an edge continues above it."""
    canny_high: Annotated[float, Field(gt=0, le=20)] = 4.0
    """Upper Canny threshold, as a multiple of the noise gradient: an edge must exceed it somewhere."""
    contrast: Annotated[float, Field(ge=0.005, le=1)] = 0.02
    """Lowest gradient of an edge, as a fraction of the picture's strongest: a lower bound for the noise."""
    colour: bool = True
    """Look for edges in red, green and blue; otherwise in grey, where two colours of equal brightness are one."""

    @model_validator(mode="after")
    def _thresholds_in_order(self) -> Self:
        if not self.flat < self.canny_low <= self.canny_high:
            raise ValueError(
                f"flat {self.flat:g} < canny_low {self.canny_low:g} <= canny_high {self.canny_high:g} must hold: "
                "a flat area is not an edge, and the lower threshold is not above the upper one"
            )
        return self

    def segment(self, picture: np.ndarray) -> SegmentMap:
        """Divide the picture at its edges; one segment if it holds nothing but noise. Raises: PictureError."""
        from .features.cells import channels
        from .regions.borders import landscape
        from .regions.merging import number_in_reading_order
        from .regions.refining import refine_labels
        from .signal.smoothing import remove_specks, slopes, smooth_at_two_scales

        near, wide, step = smooth_at_two_scales(remove_specks(channels(picture, self.colour)), self.sigma_px)
        magnitude, _, _, noise = slopes(near)
        strongest = float(magnitude.max())
        labels = self._regions(landscape(wide, self._max_steepness, noise), step) if strongest > NOTHING else None
        if labels is None:
            return one_segment(magnitude.shape)
        steep = magnitude / np.maximum(noise, np.float32(strongest / self._max_steepness))
        rows, columns = (np.arange(side) // step for side in steep.shape)
        pixels = refine_labels(labels, rows, columns, steep)
        return SegmentMap(number_in_reading_order(pixels), self._confidence(steep))

    @property
    def _max_steepness(self) -> float:
        """The upper bound of slopes in units of the noise: `contrast` times this bound starts an edge."""
        return self.canny_high / self.contrast

    def _regions(self, land: "Landscape", step: int) -> Int32[np.ndarray, "h w"] | None:
        """Return labels of every step-th pixel; None where there is only one region."""
        from .regions.borders import borders, canny_edges
        from .regions.merging import merge, weakest_border
        from .regions.watershed import MAX_SEGMENTS, STEEPER, basins, watershed

        smallest = max(4, min(self.smallest_px // step**2, land.steep.size // 16))
        markers, count = basins(land.steep, [self.flat * times for times in STEEPER], smallest)
        if count < 2:
            return None
        labels = watershed(land.steep, markers)
        edges = canny_edges(land, self.canny_low, self.canny_high, self._max_steepness)
        most = MAX_SEGMENTS if self.segments == "auto" else self.segments
        areas = np.bincount(labels.ravel(), minlength=count).tolist()
        between = borders(labels, land, edges, self.canny_high)
        parts = merge(areas, between, most)
        if self.segments == "auto":
            worth, why = weakest_border(between, parts), "the share of edges in the weakest border between two segments"
            note(log, f"segments: {np.unique(parts).size}, estimated with confidence {worth:.2f}: {why}")
        return parts[labels]

    def _confidence(self, steep: Float32[np.ndarray, "h w"]) -> Float32[np.ndarray, "h w"]:
        top = max(float(steep.max()), self.canny_high)
        return np.clip((top - steep) / np.float32(top - self.flat), 0, 1)
