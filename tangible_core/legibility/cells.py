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


FEW = 1e-3
"""Of the votes on a cell: fewer, and it is the nearest that decides."""
REACH = 4
"""Standard deviations from which on a Gaussian votes no more."""

Labels = Int32[np.ndarray, "h w"]
Cells = Bool[np.ndarray, "h w"]


def voted(labels: Labels, away: Cells, voters: Cells, sigma: float) -> Labels:
    """What is away gets the label that most of the voters around have, by a Gaussian; the nearest where none is near.

    sigma: its standard deviation, in cells.
    """
    import cv2

    found, best = filled(labels, away), np.full(labels.shape, np.float32(FEW))
    margin = int(np.ceil(REACH * sigma))
    rows, columns = labels.shape
    with plain_opencv():
        for label, box in enumerate(boxes(np.where(voters, labels + 1, 0).astype(np.int32))):
            if box is None:
                continue
            down, right = box
            there = np.s_[
                max(0, down.start - margin) : min(rows, down.stop + margin),
                max(0, right.start - margin) : min(columns, right.stop + margin),
            ]
            if not away[there].any():
                continue
            own = ((labels[there] == label) & voters[there]).astype(np.float32)
            votes = np.asarray(cv2.GaussianBlur(own, (0, 0), sigma, borderType=cv2.BORDER_REPLICATE), np.float32)
            more = away[there] & (votes > best[there])
            best[there][more] = votes[more]
            found[there][more] = label
    return found


def filled(labels: Labels, away: Cells) -> Labels:
    """What is away gets the label of the nearest cell that stays; nothing changes where none does."""
    if away.all() or not away.any():
        return labels.copy()
    return labels.reshape(-1)[nearest(~away).at]
