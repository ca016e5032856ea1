"""The filters that a picture needs, chosen from its spectrum before any filter is applied."""

import logging
from collections.abc import Sequence

import numpy as np
from jaxtyping import Bool, Float32, Float64

from tangible_core.compiled.threads import thread_count
from tangible_core.plugins.notes import note

from .gabor_bank import Gabor
from .local_energy import fft, mean_energies, spectrum_of, standardise

log: logging.Logger = logging.getLogger(__name__)

ENOUGH = 0.95
"""The share of the energy in all filters that remains when weak ones are dropped."""
NOTHING = 1e-4
"""The least share of a picture's variance that matters: the rounding of grey to 8 bits is little less."""
PAD_PX = 32
"""The width of the mirrored frame around the picture whose spectrum is taken, px."""


def needed_filters(
    grey: Float32[np.ndarray, "h w"], filters: Sequence[Gabor], skip_weak: bool, skip_octaves: bool
) -> list[Gabor]:
    """Drop filters of wavelengths absent from the picture, and weak filters, each if requested.

    The number of dropped filters is reported. Where the picture has no energy at all, every filter stays.
    """
    kept = filters_within_bandwidth(grey, filters) if skip_octaves else list(filters)
    if skip_weak:
        strong = are_strongest(mean_energies(spectrum_of(grey, PAD_PX), kept))
        kept = [each for each, keep in zip(kept, strong, strict=True) if keep]
    if len(kept) < len(filters):
        left = len(filters) - len(kept)
        note(log, f"{left} of {len(filters)} filters left out: they hold hardly any energy")
    return kept


def are_strongest(energies: Float64[np.ndarray, "filters"], share: float = ENOUGH) -> Bool[np.ndarray, "filters"]:
    """Return a mask of the fewest filters that together hold this share of the energy; all, if there is none.

    The energies of filters that hardly overlap add up, and their share is R^2, the share of the picture's variance that
    the filters reproduce: Jain & Farrokhnia, Pattern Recognition 24 (1991), sec. 3.2.
    """
    order = np.argsort(-energies, kind="stable")
    before = np.cumsum(energies[order]) - energies[order]
    kept = np.empty(energies.shape, np.bool_)
    kept[order] = before < share * energies.sum()
    return kept if kept.any() else ~kept


def filters_within_bandwidth(
    grey: Float32[np.ndarray, "h w"], filters: Sequence[Gabor], least: float = NOTHING
) -> list[Gabor]:
    """Drop filters whose wavelengths are too short for the picture; keep all if none would be left.

    A wavelength is too short if waves of up to sqrt 2 times its length, where its octave begins, and all shorter ones
    together hold less than the share `least` of the picture's variance. A cosine transform has no seam at the frame.
    """
    down, right = (np.arange(side, dtype=np.float32) / (2 * side) for side in grey.shape)
    squared = down[:, None] ** 2 + right**2
    power = np.square(fft.dctn(standardise(grey), norm="ortho", workers=thread_count()))
    shares = {
        wavelength: power[squared > 0.5 / wavelength**2].sum(dtype=np.float64) / grey.size
        for wavelength in {each.wavelength_px for each in filters}
    }
    return [each for each in filters if shares[each.wavelength_px] >= least] or list(filters)
