"""Filters that a picture does not need, known from its spectrum before any of them is applied."""

import logging
from collections.abc import Sequence

import numpy as np
from jaxtyping import Bool, Float32, Float64

from tangible_core.notes import note

from .gabor_bank import Gabor
from .local_energy import mean_energies, spectrum_of

log = logging.getLogger(__name__)

ENOUGH = 0.95
"""Of the energy in all filters, what is kept when weak ones are dropped."""
NOTHING = 1e-4
"""Of the energy in all filters: an octave with less holds little but the rounding of grey to 8 bits."""
PAD_PX = 32


def needed_filters(
    grey: Float32[np.ndarray, "h w"], filters: Sequence[Gabor], skip_weak: bool, skip_octaves: bool
) -> list[Gabor]:
    """The filters without the weak ones and without the wavelengths that the picture has not got, as asked for.

    What is left out is noted. Where the picture has no energy at all, every filter stays.
    """
    kept = np.ones(len(filters), np.bool_)
    if skip_weak or skip_octaves:
        energies = mean_energies(spectrum_of(grey, PAD_PX), filters)
        if skip_octaves:
            kept = within_bandwidth(filters, energies)
        if skip_weak:
            kept &= strongest(np.where(kept, energies, 0))
        if not kept.all():
            share = energies[~kept].sum() / energies.sum()
            note(log, f"skipped: {np.count_nonzero(~kept)} of {len(filters)} filters, with {share:.2%} of the energy")
    return [each for each, keep in zip(filters, kept, strict=True) if keep]


def strongest(energies: Float64[np.ndarray, "filters"], share: float = ENOUGH) -> Bool[np.ndarray, "filters"]:
    """The fewest filters that together hold this share of the energy; all, if there is none.

    The energies of filters that hardly overlap add up, and their share is R^2, how much of the picture's variance the
    filters reproduce: Jain & Farrokhnia, Pattern Recognition 24 (1991), sec. 3.2.
    """
    order = np.argsort(-energies, kind="stable")
    before = np.cumsum(energies[order]) - energies[order]
    kept = np.empty(energies.shape, np.bool_)
    kept[order] = before < share * energies.sum()
    return kept if kept.any() else ~kept


def within_bandwidth(
    filters: Sequence[Gabor], energies: Float64[np.ndarray, "filters"], least: float = NOTHING
) -> Bool[np.ndarray, "filters"]:
    """Whether a wavelength, or a shorter one, holds at least this share of the energy; all, if there is no energy."""
    wavelengths = np.array([each.wavelength_px for each in filters])
    present = {each for each in wavelengths if energies[wavelengths == each].sum() > least * energies.sum()}
    return wavelengths >= min(present, default=0.0)
