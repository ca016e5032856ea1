"""Method `report`: the documented baseline, the chain of the report "Tangible Images" as printed there."""

import logging
from math import ceil
from typing import TYPE_CHECKING, Annotated, Literal

import numpy as np
from jaxtyping import Float32
from pydantic import Field

from tangible_core.data import SegmentMap, to_grey
from tangible_core.plugins import note

from .signal.skipping import Dividing, one_segment

if TYPE_CHECKING:
    from .energies.gabor_bank import Gabor

log: logging.Logger = logging.getLogger(__name__)


class Report(Dividing):
    """Gabor filters, a bounded non-linearity, mean magnitude in Gaussian windows, and k-means from a random start.

    Even filters respond to grey levels of 0..255 and keep the amplitude of a wave of their own frequency. The printed
    formulas divide x' by gamma instead of the wavelength, and lack pi in the bandwidth of a given sigma; both are
    corrected. Everything is computed at the picture's full resolution, unless that would take more than memory_mb.
    Where features hardly differ, there is one segment. Colour is reduced to grey.
    Confidence is 1 - a / b, where a and b are a pixel's distances from the nearest centre and the second nearest.
    Source: Jain & Farrokhnia, Unsupervised texture segmentation using Gabor filters, Pattern Recognition 24 (1991).
    """

    segments: Annotated[int, Field(ge=1, le=64)] | Literal["auto"] = "auto"
    """Number of textures; fewer if there are fewer distinct features. auto: an estimate, at most 8."""
    frequencies: Literal["printed", "octaves"] = "printed"
    """Filter frequencies. printed: as in the report, 0.25 -+ 2^(i - 0.5) / width cycles per pixel; octaves: from
    sqrt(2)/4, halving down to `longest_px`."""
    longest_px: Annotated[float, Field(ge=3, le=512)] = 24.0
    """Longest wavelength of `octaves`, in pixels."""
    bandwidth: Annotated[float, Field(ge=0.2, le=3)] = 1.0
    """Bandwidth of each filter, in octaves at half height."""
    gamma: Annotated[float, Field(ge=0.2, le=2)] = 0.8
    """Aspect ratio of the Gaussian; at 0.8, neighbouring orientations, 30 degrees apart, meet at half height."""
    alpha: Annotated[float, Field(gt=0, le=100)] = 0.25
    """Slope of the non-linearity tanh(alpha r), where r is the response in grey levels."""
    window: Annotated[float, Field(gt=0, le=10)] = 3.0
    """Standard deviation of the averaging window, as a multiple of the filter's."""
    widest_px: Annotated[float, Field(ge=1, le=256)] = 20.0
    """Largest standard deviation of the averaging window."""
    seed: Annotated[int, Field(ge=0)] = 0
    """Seed of the random start of k-means."""
    skip_weak: bool = False
    """Drop the weakest filters, keeping 95 % of the energy."""
    skip_octaves: bool = False
    """Drop the shortest wavelengths, below which the picture has less than 0.01 % of its energy."""
    memory_mb: Annotated[int, Field(ge=16)] = 1024
    """Memory for the features; where all pixels would exceed it, every second or third is used."""

    def segment(self, picture: np.ndarray) -> SegmentMap:
        """Divide the picture by texture. Raises: PictureError as `check_picture`."""
        from .energies.filter_choice import is_flat, is_one_texture, needed_filters
        from .energies.gabor_bank import bank, octaves, printed_wavelengths
        from .kmeans.lloyd import segment_by_kmeans

        grey = to_grey(picture)
        if is_flat(grey):
            return one_segment(grey.shape)
        is_printed = self.frequencies == "printed"
        wavelengths = printed_wavelengths(grey.shape[1]) if is_printed else octaves(self.longest_px)
        every = bank(wavelengths, 6, self.bandwidth, self.gamma)
        filters = needed_filters(grey, every, self.skip_weak, self.skip_octaves)
        step_px = ceil((4 * grey.size * len(filters) / (self.memory_mb << 20)) ** 0.5)
        if step_px > 1:
            note(log, f"features every {step_px} pixels only: at every pixel they would exceed {self.memory_mb} MB")
        features = self._features(grey, filters, step_px)
        if is_one_texture(features.transpose(2, 0, 1), self.widest_px / step_px, grey):
            return one_segment(grey.shape)
        return segment_by_kmeans(features, step_px, grey.shape, self.segments, self.seed, start="random")

    def _features(
        self, grey: Float32[np.ndarray, "h w"], filters: "list[Gabor]", step_px: int
    ) -> Float32[np.ndarray, "rows columns filters"]:
        """Compute mean |tanh(alpha r)| every step_px pixels, over its maximum: k-means ignores a common scale."""
        from tangible_core.compiled import hyperbolic_tangents

        from .energies.local_energy import even_responses
        from .signal.smoothing import gaussian

        rows, columns = (-(-side // step_px) for side in grey.shape)
        features = np.empty((rows, columns, len(filters)), np.float32)
        for i, (gabor, response) in enumerate(zip(filters, even_responses(grey, filters), strict=True)):
            magnitude = np.abs(hyperbolic_tangents(np.float32(255 * self.alpha) * response))
            sigma_px = min(self.window * gabor.sigma_px, self.widest_px)
            features[..., i] = gaussian(magnitude[..., None], sigma_px)[::step_px, ::step_px, 0]
        return features / max(float(features.max()), np.finfo(np.float32).tiny)
