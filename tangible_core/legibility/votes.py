"""Cells of labels that change to those of the cells around them."""

import numpy as np
from jaxtyping import Bool, Int32

from ..runtime.opencv import plain_opencv
from .cells import boxes, nearest

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
