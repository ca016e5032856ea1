"""Tests for pictures that differ by noise or rounding only: they are one texture for any requested number."""

import numpy as np
from jaxtyping import Float32

SAME = 0.03
"""The least relative spread of features of several textures; the spread of noise is ten times as large."""
FAINT = 0.05
"""The least share of the greatest feature that carries information."""


def is_flat(grey: Float32[np.ndarray, "h w"]) -> bool:
    """Return True if all pixels have one grey, single pixels apart."""
    from ..signal.smoothing import remove_specks
    from .local_energy import standardise

    return not standardise(remove_specks(grey[..., None])[..., 0]).any()


def is_one_texture(
    amplitudes: Float32[np.ndarray, "d rows columns"], reach_cells: float, grey: Float32[np.ndarray, "h w"]
) -> bool:
    """Return True if features spread by less than SAME, or the picture's detail is too fine for them.

    Both are measured away from the frame, where mirrored waves may not continue evenly: a picture is too fine if its
    features see hardly anything but the fold at its frame. reach_cells: standard deviation of the features' windows.
    """
    frame = [min(round(4 * reach_cells), side // 4) for side in amplitudes.shape[1:]]
    inside = amplitudes[:, frame[0] : -frame[0] or None, frame[1] : -frame[1] or None]
    if inside.var(axis=(1, 2)).sum() <= SAME**2 * np.square(inside).mean(axis=(1, 2)).sum():
        return True
    rows, columns = (side // 4 for side in grey.shape)
    as_elsewhere = 2 * grey[rows : -rows or None, columns : -columns or None].std() >= grey.std()
    return bool(as_elsewhere and inside.mean(axis=(1, 2)).max() <= FAINT * amplitudes.max())
