"""Filters that a picture does not need, known from its spectrum before any of them is applied."""

import logging
from collections.abc import Sequence

import numpy as np
from jaxtyping import Bool, Float32, Float64

from tangible_core.compiled.threads import thread_count
from tangible_core.plugins.notes import note

from .gabor_bank import Gabor
from .local_energy import fft, mean_energies, spectrum_of, standardise

log = logging.getLogger(__name__)

ENOUGH = 0.95
"""Of the energy in all filters, what is kept when weak ones are dropped."""
NOTHING = 1e-4
"""Of a picture's variance: less is not much more than the rounding of grey to 8 bits."""
PAD_PX = 32


def needed_filters(
    grey: Float32[np.ndarray, "h w"], filters: Sequence[Gabor], skip_weak: bool, skip_octaves: bool
) -> list[Gabor]:
    """The filters without wavelengths that the picture has not got, and without the weak ones, as asked for.

    How many are left out is noted. Where the picture has no energy at all, every filter stays.
    """
    kept = filters_within_bandwidth(grey, filters) if skip_octaves else list(filters)
    if skip_weak:
        strong = are_strongest(mean_energies(spectrum_of(grey, PAD_PX), kept))
        kept = [each for each, keep in zip(kept, strong, strict=True) if keep]
    if len(kept) < len(filters):
        left = len(filters) - len(kept)
        note(log, f"skipped: {left} of {len(filters)} filters, in which there is hardly any energy")
    return kept


def are_strongest(energies: Float64[np.ndarray, "filters"], share: float = ENOUGH) -> Bool[np.ndarray, "filters"]:
    """The fewest filters that together hold this share of the energy; all, if there is none.

    The energies of filters that hardly overlap add up, and their share is R^2, how much of the picture's variance the
    filters reproduce: Jain & Farrokhnia, Pattern Recognition 24 (1991), sec. 3.2.
    """
    order = np.argsort(-energies, kind="stable")
    before = np.cumsum(energies[order]) - energies[order]
    kept = np.empty(energies.shape, np.bool_)
    kept[order] = before < share * energies.sum()
    return kept if kept.any() else ~kept


def filters_within_bandwidth(
    grey: Float32[np.ndarray, "h w"], filters: Sequence[Gabor], least: float = NOTHING
) -> list[Gabor]:
    """The filters of wavelengths that are not too short for the picture; all, if they all are, or it is flat.

    Too short is a wavelength if waves of up to sqrt 2 times as long, where its octave begins, and all shorter ones
    together hold less than this share of the picture's variance. A cosine transform has no seam at the frame.
    """
    down, right = (np.arange(side, dtype=np.float32) / (2 * side) for side in grey.shape)
    squared = down[:, None] ** 2 + right**2
    power = np.square(fft.dctn(standardise(grey), norm="ortho", workers=thread_count()))
    shares = {
        wavelength: power[squared > 0.5 / wavelength**2].sum(dtype=np.float64) / grey.size
        for wavelength in {each.wavelength_px for each in filters}
    }
    return [each for each in filters if shares[each.wavelength_px] >= least] or list(filters)
