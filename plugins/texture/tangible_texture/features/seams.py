"""Seams: strips between two textures that a window over both of them makes into a third."""

import numpy as np
from jaxtyping import Bool, Int32


def remove_seams(
    labels: Int32[np.ndarray, "rows columns"], radius: int
) -> tuple[Int32[np.ndarray, "rows columns"], Bool[np.ndarray, "rows columns"]]:
    """Labels in which every part of a segment that no disc of this radius fits into goes to what is nearest by.

    Segments that are nowhere so wide vanish, and the others are numbered anew. Outside lies the mirror image. Where
    nothing is so wide, everything stays.
    Returns: the labels, and where they are still those of the same segment.
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
