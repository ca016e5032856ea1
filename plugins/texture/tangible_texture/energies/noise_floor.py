"""Pictures in which nothing but noise or rounding differs: one texture, however many are asked for."""

import numpy as np
from jaxtyping import Float32

SAME = 0.03
"""Features that spread by less than this share of their size are those of one texture: noise has ten times as much."""
FAINT = 0.05
"""Features that come to less than this share of the greatest one say nothing."""


def is_flat(grey: Float32[np.ndarray, "h w"]) -> bool:
    """Whether all is one grey but for single pixels."""
    from ..signal.smoothing import remove_specks
    from .local_energy import standardise

    return not standardise(remove_specks(grey[..., None])[..., 0]).any()


def is_one_texture(
    amplitudes: Float32[np.ndarray, "d rows columns"], reach_cells: float, grey: Float32[np.ndarray, "h w"]
) -> bool:
    """Whether features spread by less than SAME, or what differs in the picture is too fine for them.

    Looked at away from the frame, where mirrored waves may not go on evenly: too fine is a picture of which features
    see hardly anything but the fold at its frame. reach_cells: the standard deviation of the features' windows.
    """
    frame = [min(round(4 * reach_cells), side // 4) for side in amplitudes.shape[1:]]
    inside = amplitudes[:, frame[0] : -frame[0] or None, frame[1] : -frame[1] or None]
    if inside.var(axis=(1, 2)).sum() <= SAME**2 * np.square(inside).mean(axis=(1, 2)).sum():
        return True
    rows, columns = (side // 4 for side in grey.shape)
    as_elsewhere = 2 * grey[rows : -rows or None, columns : -columns or None].std() >= grey.std()
    return bool(as_elsewhere and inside.mean(axis=(1, 2)).max() <= FAINT * amplitudes.max())
