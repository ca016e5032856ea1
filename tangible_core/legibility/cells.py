"""Cells of a grid: the nearest that are wanted, and boxes around those of one number."""
# scipy has no types.
# pyright: reportMissingTypeStubs=false, reportUnknownVariableType=false, reportUnknownMemberType=false
# pyright: reportUnknownArgumentType=false

from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float32, Int32, Int64

from ..runtime.opencv import plain_opencv

Box = tuple[slice, slice]


class Nearest(NamedTuple):
    """To the nearest cell that is wanted."""

    far: Float32[np.ndarray, "h w"]
    """Cells, to 2 %."""
    at: Int64[np.ndarray, "h w"]
    """Its place, counted row by row."""


def nearest(wanted: Bool[np.ndarray, "h w"]) -> Nearest:
    """From each cell to the nearest that is wanted, of which there must be one."""
    import cv2

    with plain_opencv():
        far, label = cv2.distanceTransformWithLabels(
            (~wanted).view(np.uint8), cv2.DIST_L2, cv2.DIST_MASK_5, labelType=cv2.DIST_LABEL_PIXEL
        )
    labels = np.asarray(label, np.int32)
    at = np.zeros(int(labels.max()) + 1, np.int64)
    at[labels[wanted]] = np.flatnonzero(wanted)
    return Nearest(np.asarray(far, np.float32), at[labels])


def boxes(labels: Int32[np.ndarray, "h w"]) -> list[Box | None]:
    """The box around the cells of each number from 1 on; None for one that has no cell."""
    from scipy.ndimage import find_objects

    return [None if box is None else (box[0], box[1]) for box in find_objects(labels)]
