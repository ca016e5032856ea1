"""The filters that a picture needs, and pictures that need none, as they differ by noise or rounding only."""

import logging
from collections.abc import Sequence

import numpy as np
from jaxtyping import Bool, Float32, Float64

from tangible_core.compiled import thread_count
from tangible_core.plugins import note

from ..signal.smoothing import remove_specks
from .gabor_bank import Gabor
from .local_energy import fft, mean_energies, picture_spectrum, standardise

# The least relative spread of features of several textures; the spread of noise is ten times as large.
SAME = 0.03
FAINT = 0.05  # the least share of the greatest feature that carries information


def is_flat(grey: Float32[np.ndarray, "h w"]) -> bool:
    """Return True if all pixels have one grey, single pixels apart."""
    return not standardise(remove_specks(grey[..., None])[..., 0]).any()


def is_one_texture(
    amplitudes: Float32[np.ndarray, "d rows columns"], reach_cells: float, grey: Float32[np.ndarray, "h w"]
) -> bool:
    """Return True if features spread by less than SAME, or the picture's detail is too fine for them."""
    # Measured away from the frame, where mirrored waves may not continue evenly: a picture is too fine if its features
    # see hardly anything but the fold at its frame.
    frame = [min(round(4 * reach_cells), side // 4) for side in amplitudes.shape[1:]]
    inside = amplitudes[:, frame[0] : -frame[0] or None, frame[1] : -frame[1] or None]
    if inside.var(axis=(1, 2)).sum() <= SAME**2 * np.square(inside).mean(axis=(1, 2)).sum():
        return True
    rows, columns = (side // 4 for side in grey.shape)
    as_elsewhere = 2 * grey[rows : -rows or None, columns : -columns or None].std() >= grey.std()
    return bool(as_elsewhere and inside.mean(axis=(1, 2)).max() <= FAINT * amplitudes.max())


log: logging.Logger = logging.getLogger(__name__)

ENOUGH = 0.95
# The least share of a picture's variance that matters: the rounding of grey to 8 bits is little less.
NOTHING = 1e-4
PAD_PX = 32


def needed_filters(
    grey: Float32[np.ndarray, "h w"], filters: Sequence[Gabor], skip_weak: bool, skip_octaves: bool
) -> list[Gabor]:
    """Drop filters of wavelengths absent from the picture, and weak filters, each if requested, with a note."""
    needed = filters_within_bandwidth(grey, filters) if skip_octaves else list(filters)
    if skip_weak:
        strong = are_strongest(mean_energies(picture_spectrum(grey, PAD_PX), needed))
        needed = [gabor for gabor, keep in zip(needed, strong, strict=True) if keep]
    if len(needed) < len(filters):
        dropped_count = len(filters) - len(needed)
        note(log, f"{dropped_count} of {len(filters)} filters left out: they hold hardly any energy")
    return needed


def are_strongest(energies: Float64[np.ndarray, "filters"], share: float = ENOUGH) -> Bool[np.ndarray, "filters"]:
    """Return a mask of the fewest filters that together hold this share of the energy; all, if there is none."""
    # The energies of filters that hardly overlap add up, and their share is R^2, the share of the picture's variance
    # that the filters reproduce: Jain & Farrokhnia, Pattern Recognition 24 (1991), sec. 3.2.
    order = np.argsort(-energies, kind="stable")
    before = np.cumsum(energies[order]) - energies[order]
    mask = np.empty(energies.shape, np.bool_)
    mask[order] = before < share * energies.sum()
    return mask if mask.any() else ~mask


def filters_within_bandwidth(
    grey: Float32[np.ndarray, "h w"], filters: Sequence[Gabor], least: float = NOTHING
) -> list[Gabor]:
    """Drop filters whose wavelengths are too short for the picture; keep all if none would be left."""
    down, right = (np.arange(side, dtype=np.float32) / (2 * side) for side in grey.shape)
    square_frequency = down[:, None] ** 2 + right**2
    power = np.square(fft.dctn(standardise(grey), norm="ortho", workers=thread_count()))
    # A wavelength is too short if waves of up to sqrt 2 times its length, where its octave begins, and all shorter ones
    # together hold less than `least` of the variance. A cosine transform has no seam at the frame.
    shares = {
        wavelength: power[square_frequency > 0.5 / wavelength**2].sum(dtype=np.float64) / grey.size
        for wavelength in {gabor.wavelength_px for gabor in filters}
    }
    return [gabor for gabor in filters if shares[gabor.wavelength_px] >= least] or list(filters)
