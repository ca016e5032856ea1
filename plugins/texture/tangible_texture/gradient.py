"""Segments by gradient: flat basins, flooded up to the edges between them."""

from typing import Annotated, Literal, Self

import numpy as np
from jaxtyping import Float32, Int32, UInt8
from pydantic import Field, model_validator

from tangible_core.data import SegmentMap, Views
from tangible_core.interfaces import Segmenter, Skippable
from tangible_core.pictures import is_one_colour

MOST_SEGMENTS = 64
"""What `segments: auto` stops at, far beyond what touch tells apart."""

STEEPER = (1, 4, 16)
"""Where nothing is flat, a part this many times as steep counts as flat."""

NOTHING = 1e-6
"""A slope, per pixel, that rounding can make of one colour when white is 1."""


class Gradient(Segmenter, Skippable):
    """Regions between edges: a watershed of the gradient and Canny edges; for smooth things rather than textures.

    Smooth the picture; take the slope of its steepest channel, in units of the noise hereabouts. Connected flat parts
    are the first segments. They grow uphill until they meet (a watershed), and two of them stay apart if two fifths or
    more of the border between them lie on Canny edges. Labels are in the order of their first pixels, row by row.
    Confidence is 1 - (s - flat) / (top - flat) within 0..1, s being the slope in units of noise and top its maximum,
    or canny_high if that is more: 1 in a flat basin, 0 on the strongest edge.
    Sources: Canny, A computational approach to edge detection, 1986; Meyer, Un algorithme optimal pour la ligne de
    partage des eaux, 1991.
    """

    segments: Annotated[int, Field(ge=1)] | Literal["auto"] = "auto"
    """At most this many: the least separated ones are merged; `auto`: as many as edges hold apart, 64 at most."""
    sigma_px: Annotated[float, Field(gt=0, le=100)] = 2.0
    """Standard deviation of the Gaussian that smooths, at most 1/16 of the root of the picture's area."""
    smallest_px: Annotated[int, Field(ge=1)] = 200
    """A segment begins with at least this many flat pixels; in a small picture, 1/16 of its area; never under 4."""
    flat: Annotated[float, Field(gt=0, le=20)] = 1.4
    """Flat is a slope up to this many times that of noise; in a part without any, 4 or 16 times as much will do."""
    canny_low: Annotated[float, Field(gt=0, le=20)] = 2.0
    """An edge goes on while its slope is this many times that of noise."""
    canny_high: Annotated[float, Field(gt=0, le=20)] = 4.0
    """An edge has this many times the slope of noise somewhere."""
    contrast: Annotated[float, Field(ge=0.005, le=1)] = 0.02
    """An edge has at least this share of the slope of the picture's strongest edge: the floor under the noise."""
    colour: bool = True
    """Look for edges in red, green and blue; else in grey, where two colours of one brightness are one."""

    @model_validator(mode="after")
    def _thresholds_in_order(self) -> Self:
        if not self.flat < self.canny_low <= self.canny_high:
            raise ValueError(
                f"flat {self.flat:g} < canny_low {self.canny_low:g} <= canny_high {self.canny_high:g} does not hold; "
                "what is flat is no edge, and an edge goes on at less than it begins with"
            )
        return self

    def skip(self, views: Views) -> str | None:
        """One flat colour is one segment."""
        return "the picture is one flat colour" if is_one_colour(views.left) else None

    def segment(self, picture: np.ndarray) -> SegmentMap:
        """Regions of the picture; one where nothing but noise is found in it.

        Raises: PictureError as `check_picture`.
        """
        from .basins import basins
        from .channels import channels
        from .slopes import slopes
        from .smoothing import gaussian, without_specks
        from .watershed import watershed

        values = without_specks(channels(picture, self.colour))
        smooth = gaussian(values, min(self.sigma_px, (values.shape[0] * values.shape[1]) ** 0.5 / 16))
        magnitude, across, down, noise = slopes(smooth)
        strongest = float(magnitude.max())
        if strongest <= NOTHING:
            return SegmentMap(np.zeros(magnitude.shape, np.int32))
        noise = np.maximum(noise, np.float32(self.contrast * strongest / self.canny_high))
        steep = magnitude / noise
        smallest_px = max(4, min(self.smallest_px, steep.size // 16))
        markers, count = basins(steep, [self.flat * times for times in STEEPER], smallest_px)
        if count < 2:
            return SegmentMap(np.zeros(magnitude.shape, np.int32))
        labels = self._merged(watershed(steep, markers), count, steep, self._edges(across, down, noise))
        return SegmentMap(labels, self._confidence(steep))

    def _edges(
        self, across: Float32[np.ndarray, "h w"], down: Float32[np.ndarray, "h w"], noise: Float32[np.ndarray, "h w"]
    ) -> UInt8[np.ndarray, "h w"]:
        """Where Canny finds an edge within one pixel, in units of the noise."""
        import cv2

        unit = 16000 * self.contrast / self.canny_high  # no slope is above canny_high / contrast: 16 bits will hold it
        rate = np.float32(unit) / noise
        x, y = (cv2.multiply(slope, rate, dtype=cv2.CV_16S) for slope in (across, down))
        edges = cv2.Canny(x, y, unit * self.canny_low, unit * self.canny_high, L2gradient=True)
        return cv2.dilate(edges, np.ones((3, 3), np.uint8))

    def _merged(
        self,
        labels: Int32[np.ndarray, "h w"],
        count: int,
        steep: Float32[np.ndarray, "h w"],
        edges: UInt8[np.ndarray, "h w"],
    ) -> Int32[np.ndarray, "h w"]:
        from .borders import borders
        from .merging import in_reading_order, merge

        areas = np.bincount(labels.ravel(), minlength=count).tolist()
        most = MOST_SEGMENTS if self.segments == "auto" else self.segments
        return in_reading_order(labels, merge(areas, borders(labels, steep, edges), most))

    def _confidence(self, steep: Float32[np.ndarray, "h w"]) -> Float32[np.ndarray, "h w"]:
        top = max(float(steep.max()), self.canny_high)
        return np.clip((top - steep) / np.float32(top - self.flat), 0, 1)
