"""Method `kornia-gradient`: Canny edges and the slope of the picture in torch, then regions between the edges."""

from math import ceil
from typing import Annotated, Literal, Self

import numpy as np
from jaxtyping import Float32, Int32
from pydantic import Field, model_validator

from tangible_core.data import SegmentMap, to_grey
from tangible_core.runtime import TorchDevice, need, pick_device

from .signal.skipping import Dividing, one_segment

# The share of the slopes taken as noise; the largest of these is that quantile of a Rayleigh distribution.
QUIET = 0.25
SOBEL = 8
"""The factor between the sums of kornia's Canny, which leaves Sobel's unnormalised, and slopes per pixel."""


class KorniaGradient(Dividing):
    """Regions between edges, by kornia: for smooth things rather than textures.

    The picture is reduced to grey and smoothed; Canny edges and slopes are in units of the noise, and the slope is
    raised on edges. Connected areas under canny_low start segments, which grow uphill until they meet (a watershed).
    Confidence is 1 - s / top, where s is the slope in units of noise and top the larger of its maximum and canny_high.
    Sources: Canny 1986; Meyer 1991; Riba et al., Kornia, WACV 2020.
    """

    segments: Annotated[int, Field(ge=1)] | Literal["auto"] = "auto"
    """Largest number of segments, seeded by the largest basins; `auto`: as many as edges close off, at most 64."""
    sigma_px: Annotated[float, Field(gt=0, le=100)] = 2.0
    """Standard deviation of the smoothing Gaussian, limited to 1/16 of the square root of the picture's area."""
    smallest_px: Annotated[int, Field(ge=1)] = 200
    """Smallest flat area that starts a segment; limited to 1/16 of a small picture's area, and never under 4."""
    canny_low: Annotated[float, Field(gt=0, le=20)] = 2.0
    """Lower Canny threshold, as a multiple of the noise gradient: an edge continues above it."""
    canny_high: Annotated[float, Field(gt=0, le=20)] = 4.0
    """Upper Canny threshold, as a multiple of the noise gradient: an edge must exceed it somewhere."""
    contrast: Annotated[float, Field(ge=0.005, le=1)] = 0.02
    """Lowest gradient of an edge, as a fraction of the picture's strongest: a lower bound for the noise."""
    torch_device: TorchDevice = "auto"
    """Device to compute on; `auto` uses a GPU if there is one."""

    @model_validator(mode="after")
    def _thresholds_in_order(self) -> Self:
        if self.canny_low > self.canny_high:
            raise ValueError(f"canny_low {self.canny_low:g} is above canny_high {self.canny_high:g}; swap them")
        return self

    def segment(self, picture: np.ndarray) -> SegmentMap:
        """Divide the picture at its edges. Raises: PictureError as `check_picture`, BrokenMethod without torch."""
        need("torch")
        need("kornia")
        from .energies.filter_choice import is_flat
        from .regions.merging import number_in_reading_order
        from .regions.watershed import watershed

        grey = to_grey(picture)
        if is_flat(grey):
            return one_segment(grey.shape)
        steep = self._landscape(grey / np.abs(grey).max())
        markers, count = self._markers(steep)
        if count < 2:
            return one_segment(grey.shape)
        top = max(float(steep.max()), self.canny_high)
        return SegmentMap(number_in_reading_order(watershed(steep, markers)), 1 - steep / np.float32(top))

    def _landscape(self, grey: Float32[np.ndarray, "h w"]) -> Float32[np.ndarray, "h w"]:
        """Compute the slope in units of the noise, at least canny_high on edges."""
        import torch
        from kornia.filters import canny, gaussian_blur2d, spatial_gradient

        sigma_px = min(self.sigma_px, grey.size**0.5 / 16)
        reach = ceil(3 * sigma_px)
        size, sigma, frame = 2 * reach + 1, (sigma_px, sigma_px), reach + 2
        inner = (..., slice(frame, -frame), slice(frame, -frame))
        tensor = torch.from_numpy(np.pad(grey, frame, mode="symmetric")).to(pick_device(self.torch_device))[None, None]
        slopes = spatial_gradient(gaussian_blur2d(tensor, size, sigma))[inner].norm(dim=2)
        quiet = torch.sort(slopes.flatten()).values[int(QUIET * slopes.numel())] / (-2 * np.log(1 - QUIET)) ** 0.5
        unit = torch.maximum(quiet, self.contrast * slopes.max() / self.canny_high)
        low, high = SOBEL * self.canny_low, SOBEL * self.canny_high
        _, edges = canny(tensor / unit, low, high, size, sigma)
        steep = slopes / unit
        return torch.where(edges[inner] > 0, steep.clamp(min=self.canny_high), steep)[0, 0].cpu().numpy()

    def _markers(self, steep: Float32[np.ndarray, "h w"]) -> tuple[Int32[np.ndarray, "h w"], int]:
        """Return the largest basins under canny_low, or its multiples if none is so flat, -1 elsewhere; count them."""
        from .regions.watershed import MAX_SEGMENTS, STEEPER, basins

        levels = [self.canny_low * times for times in STEEPER]
        basin_labels, count = basins(steep, levels, max(4, min(self.smallest_px, steep.size // 16)))
        most = min(count, MAX_SEGMENTS if self.segments == "auto" else self.segments)
        largest = np.argsort(-np.bincount(basin_labels[basin_labels >= 0], minlength=count), kind="stable")[:most]
        names = np.full(count + 1, -1, np.int32)  # the last one is indexed by -1
        names[largest] = np.arange(most)
        return names[basin_labels], most
