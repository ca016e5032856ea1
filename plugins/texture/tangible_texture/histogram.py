"""Segments by histogram: thresholds of grey that divide it best."""

import logging
from typing import Annotated, Literal

import numpy as np
from jaxtyping import Bool, Float32, Float64, Int32, Int64
from pydantic import Field

from tangible_core.data import SegmentMap
from tangible_core.plugins import note

from .signal.skipping import Dividing, one_segment

# The number of grey levels between the darkest and the brightest: that of 8 bits.
BINS = 256
# The largest number of segments under `auto`: more than the modes of any histogram seen.
MAX_LEVELS = 16
# The share of the pixels, the flattest ones, that make up the histogram: edges have levels of their own.
FLAT_SHARE = 0.8
NOTHING = 1e-6
"""The largest difference of grey that rounding can produce in a picture of one colour, when white is 1."""
# The largest ratio of Marriott's criterion at which levels count as several classes.
CLEAR = 0.75

log: logging.Logger = logging.getLogger(__name__)
GreyLevels = Float64[np.ndarray, "n"]


class OtsuClasses:
    """The best divisions of sorted grey levels, `counts` pixels each, into 1..most classes."""

    def __init__(self, levels: GreyLevels, counts: Int64[np.ndarray, "n"], most: int) -> None:
        spread = _spread_within(levels - np.average(levels, weights=counts), counts)
        self._rounding = counts.sum() * np.ptp(levels) ** 2 / (12 * 255**2)  # the variance of rounding to 8 bits
        best = spread[0]
        self.spreads: list[float] = [best[-1]]
        """The sums of squares within the classes, for 1, 2, ... classes."""
        self._last_starts: list[np.ndarray] = []
        # The variance within the classes is least (Otsu 1979). It is a sum over classes, so that dynamic programming
        # minimises it for n levels in n^2 steps a class (Fisher, On grouping for maximum homogeneity, 1958).
        for _ in range(1, min(most, len(levels))):
            every = best[:, None] + spread
            self._last_starts.append(every.argmin(axis=0))
            best = every.min(axis=0)
            self.spreads.append(best[-1])

    def starts(self, classes: int) -> Int64[np.ndarray, "k"]:
        """Return the index of the first level of each class."""
        end = len(self._last_starts[0]) - 1 if self._last_starts else 0
        starts: list[int] = []
        for last in reversed(self._last_starts[: classes - 1]):
            end = int(last[end])
            starts.append(end)
        return np.array([0, *reversed(starts)])

    def clearest(self) -> tuple[int, float]:
        """Return the number of classes k with the least k^2 W(k) / W(1), or 1 if that is above CLEAR; and the ratio."""
        # W(k) is the variance within. Evenly spread levels have the ratio 1 for every k, one Gaussian's have more for
        # every k but 1 (Marriott, Practical problems in a method of cluster analysis, 1971).
        ratios = [(k**2 * (spread + self._rounding) / self.spreads[0], k) for k, spread in enumerate(self.spreads, 1)]
        ratio, classes = min(ratios)
        return (classes, float(ratio)) if ratio <= CLEAR else (1, 1.0)


def _spread_within(levels: GreyLevels, counts: Int64[np.ndarray, "n"]) -> Float64[np.ndarray, "m m"]:
    """Return the sum of squares about its mean of each class first..end-1; infinite where the class is empty."""
    count, total, squares = (np.concatenate([[0], np.cumsum(counts * levels**power)]) for power in (0, 1, 2))
    number = count - count[:, None]
    with np.errstate(divide="ignore", invalid="ignore"):
        spread = (squares - squares[:, None]) - (total - total[:, None]) ** 2 / number
    return np.where(np.triu(np.ones(spread.shape, np.bool_), 1), np.maximum(spread, 0), np.inf)


class Histogram(Dividing):
    """Grey levels, divided by the optimal thresholds of the histogram; a segment may lie in many places.

    For flat drawings and scenes of a few even tones. It does not see texture or colour: take `gabor` or `hierarchy`.

    >>> import numpy as np
    >>> from tangible import Histogram
    >>> picture = np.zeros((32, 32), np.uint8)
    >>> picture[8:24, 8:24] = 200
    >>> Histogram(segments=2).segment(picture).labels[[0, 16], 16].tolist()
    [0, 1]

    The picture is reduced to grey and smoothed; the 256 grey levels of its flattest four fifths are divided so that the
    variance within the classes is least (Otsu's criterion for several thresholds, its exact optimum). Edges have levels
    of their own, which are not segments: edges and parts that are too small go to the adjacent segments.
    There are never more segments than grey levels in the picture. Labels are in the order of their first pixels, row by
    row. Confidence is the distance from the nearest threshold, in units of twice the standard deviation of the pixel's
    class, 1 at most; 0 where the pixel went to another class.
    `auto` takes the number of segments k with the least k^2 W(k), W being the variance within, if that is at most three
    quarters of W(1); evenly spread levels are one segment, as are those of one Gaussian. The confidence of that choice,
    1 - k^2 W(k) / W(1), is reported.
    Memory: 50 bytes a pixel beyond the picture.
    Sources: Otsu, A threshold selection method from gray-level histograms, 1979; Marriott, Practical problems in a
    method of cluster analysis, 1971.
    """

    segments: Annotated[int, Field(ge=1)] | Literal["auto"] = "auto"
    """Largest number of segments; `auto`: as many as the histogram has clear modes, at most 16."""
    sigma_px: Annotated[float, Field(ge=0, le=100)] = 2.0
    """Standard deviation of the smoothing Gaussian, limited to 1/16 of the square root of the picture's area; 0 for
    none."""
    smallest_px: Annotated[int, Field(ge=1)] = 50
    """Connected parts with fewer flat pixels are merged into their neighbours; limited to 1/16 of a small picture's
    area. 1 leaves every pixel in the class of its own grey level."""

    def segment(self, picture: np.ndarray) -> SegmentMap:
        """Divide the picture by grey level; one segment where all of it has the same grey. Raises: PictureError."""
        from .features.cells import channels
        from .regions.merging import number_in_reading_order
        from .regions.refining import remove_small_parts
        from .signal.smoothing import gaussian, remove_specks, slopes

        values = remove_specks(channels(picture, colour=False))
        sigma_px = min(self.sigma_px, values.size**0.5 / 16)
        grey = gaussian(values, sigma_px)[..., 0] if sigma_px else values[..., 0]
        if float(np.ptp(grey)) <= NOTHING:
            return one_segment(grey.shape)
        steep = slopes(grey[..., None])[0]
        flat = 1.001 * float(np.quantile(steep, FLAT_SHARE)) + NOTHING  # slopes that are equal differ by rounding
        classes, confidence = self._classes(grey, steep <= flat, np.unique(_bins(values)).size)
        smallest_px = min(self.smallest_px, classes.size // 16)
        labels = remove_small_parts(classes, steep, flat, smallest_px) if smallest_px > 1 else classes
        confidence[labels != classes] = 0
        return SegmentMap(number_in_reading_order(labels), confidence)

    def _classes(
        self, grey: Float32[np.ndarray, "h w"], flat: Bool[np.ndarray, "h w"], most: int
    ) -> tuple[Int32[np.ndarray, "h w"], Float32[np.ndarray, "h w"]]:
        """Return each pixel's class, from dark to bright, and its confidence; `most` bounds the number of classes."""
        bins = _bins(grey)
        pixels = np.bincount(bins[flat], minlength=BINS)
        occupied = np.flatnonzero(pixels)
        levels = np.bincount(bins[flat], grey[flat])[occupied] / pixels[occupied]
        divisions = OtsuClasses(
            levels, pixels[occupied], min(most, MAX_LEVELS if self.segments == "auto" else self.segments)
        )
        starts = divisions.starts(self._number(divisions))[1:]
        thresholds = (levels[starts] + levels[starts - 1]) / 2
        classes = np.searchsorted(thresholds, grey).astype(np.int32)
        return classes, _confidence(grey, classes, thresholds)

    def _number(self, divisions: OtsuClasses) -> int:
        if self.segments != "auto":
            return len(divisions.spreads)
        number, ratio = divisions.clearest()
        why = "it leaves the least spread of grey levels for its size"
        note(log, f"segments: {number}, estimated with confidence {1 - ratio:.2f}: {why}")
        return number


def _bins(grey: Float32[np.ndarray, "..."]) -> Int32[np.ndarray, "..."]:
    low, high = grey.min(), grey.max()
    return ((grey - low) * np.float32((BINS - 1e-3) / (high - low) if high > low else 0)).astype(np.int32)


def _confidence(
    grey: Float32[np.ndarray, "h w"], classes: Int32[np.ndarray, "h w"], thresholds: np.ndarray
) -> Float32[np.ndarray, "h w"]:
    """Return the distance from the nearest threshold over twice the class's spread, which is at least half a bin."""
    edges = np.concatenate([[-np.inf], thresholds, [np.inf]])
    sizes = np.bincount(classes.ravel())
    mean, square = (np.bincount(classes.ravel(), (grey**power).ravel()) / sizes for power in (1, 2))
    spread = np.maximum(np.sqrt(np.maximum(square - mean**2, 0)), np.ptp(grey) / BINS / 2)
    distance = np.minimum(grey - edges[classes], edges[classes + 1] - grey)
    return np.clip(distance / (2 * spread[classes]), 0, 1).astype(np.float32)
