"""Seams: strips between two textures that look like a third in a window over both."""

import numpy as np
from jaxtyping import Bool, Int32


def remove_seams(
    labels: Int32[np.ndarray, "rows columns"], radius: int
) -> tuple[Int32[np.ndarray, "rows columns"], Bool[np.ndarray, "rows columns"]]:
    """Give every part of a segment that is too narrow for a disc of this radius to the nearest wide segment.

    Segments that are narrow everywhere vanish, and the others are renumbered. Outside lies the mirror image. Where no
    segment is wide enough, all stay.
    Returns: the labels, and a mask of the cells that kept their segment.
    """
    import cv2
    from scipy.ndimage import distance_transform_edt

    disc = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (2 * radius + 1, 2 * radius + 1))
    framed = np.pad(labels, 2 * radius, mode="symmetric")
    inner = tuple(slice(2 * radius, 2 * radius + side) for side in labels.shape)
    wide = np.zeros(labels.shape, np.bool_)
    for each in range(int(labels.max()) + 1):
        wide |= cv2.morphologyEx((framed == each).astype(np.uint8), cv2.MORPH_OPEN, disc)[inner] > 0
    if not wide.any():
        return labels, ~wide
    nearest = distance_transform_edt(~wide, return_distances=False, return_indices=True)
    _, numbered = np.unique(labels[tuple(np.asarray(nearest))], return_inverse=True)
    return numbered.reshape(labels.shape).astype(np.int32), wide
