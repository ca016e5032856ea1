"""Operations on the cells of a label map: boxes, discs, filling and voting."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Int32

from tangible_core.drawing import nearest
from tangible_core.runtime import cv2, plain_opencv

Box = tuple[slice, slice]


def boxes(labels: Int32[np.ndarray, "h w"]) -> list[Box | None]:
    """Return the box around the cells of each number from 1 on; None for a number without a cell."""
    from scipy.ndimage import find_objects

    return [None if box is None else (box[0], box[1]) for box in find_objects(labels)]


def resampled(values: np.ndarray, shape: tuple[int, ...]) -> np.ndarray:
    """Return the values under the centres of the cells of another grid, of the same extent."""
    index = [((np.arange(new) + 0.5) * old / new).astype(int) for new, old in zip(shape, values.shape, strict=True)]
    return values[np.ix_(*index)]


FEW = 1e-3  # share of the votes on a cell below which the nearest cell decides
REACH = 4  # radius of the Gaussian of votes, in standard deviations

Labels = Int32[np.ndarray, "h w"]
Cells = Bool[np.ndarray, "h w"]


def vote(labels: Labels, removed: Cells, voters: Cells, sigma: float) -> Labels:
    """Give removed cells the label of most voters around, by a Gaussian of sigma cells, or the nearest label."""
    winners, best = fill(labels, removed), np.full(labels.shape, np.float32(FEW))
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
            if not removed[there].any():
                continue
            own = ((labels[there] == label) & voters[there]).astype(np.float32)
            votes = np.asarray(cv2.GaussianBlur(own, (0, 0), sigma, borderType=cv2.BORDER_REPLICATE), np.float32)
            more = removed[there] & (votes > best[there])
            best[there][more] = votes[more]
            winners[there][more] = label
    return winners


def fill(labels: Labels, removed: Cells) -> Labels:
    """Give removed cells the label of the nearest remaining cell; change nothing if none remains."""
    if removed.all() or not removed.any():
        return labels.copy()
    return labels.reshape(-1)[nearest(~removed)[1]]


ALIKE = 0.95
"""The share of the largest disc's radius from which on a disc may be chosen, if it is closer to its part's middle."""


class Disc(NamedTuple):
    """A disc in pixels."""

    column: float
    row: float
    radius_px: float


def largest_disc(part: Bool[np.ndarray, "h w"]) -> Disc | None:
    """Return the largest disc within a part and the picture; None for a part that is too small to be drawn."""
    if not part.any():
        return None
    rows, columns = (np.flatnonzero(part.any(axis=axis)) for axis in (1, 0))
    top, left = int(rows[0]), int(columns[0])
    cut = part[top : int(rows[-1]) + 1, left : int(columns[-1]) + 1]
    with plain_opencv():
        depth = cv2.distanceTransform(np.pad(cut, 1).astype(np.uint8), cv2.DIST_L2, 5)
    widest = np.argwhere(depth >= ALIKE * depth.max())
    row, column = widest[np.square(widest - np.argwhere(np.pad(cut, 1)).mean(axis=0)).sum(axis=1).argmin()].tolist()
    return Disc(left + column - 1.0, top + row - 1.0, float(depth[row, column]))
