"""Parts as pins show them: one part a pin, the one that has most of its cell."""

from typing import NamedTuple

import numpy as np

from ..data import PartMap
from ..runtime.opencv import plain_opencv

PIN_PITCH_M = 0.0025
"""From pin to pin of displays of braille, which all have about this pitch."""


class Shown(NamedTuple):
    """What pins show."""

    parts: tuple[tuple[int, int, tuple[int, int]], ...]
    """Of each part: its number, its pins, and a cell of it on the grid of the parts."""
    kept: float
    """Share of the length of all borders that lies within a pin of a border that is shown; 1 where there is none."""


def pins_of(parts: PartMap, pitch_m: float) -> Shown:
    """What is shown of parts whose cells are pitch_m wide."""
    labels = parts.labels
    cell = max(1.0, PIN_PITCH_M / pitch_m)
    rows, columns = (max(1, round(size / cell)) for size in labels.shape)
    down = np.arange(labels.shape[0], dtype=np.int64) * rows // labels.shape[0]
    right = np.arange(labels.shape[1], dtype=np.int64) * columns // labels.shape[1]
    pin = np.add.outer(down * columns, right)
    pairs, votes = np.unique(pin * parts.count + labels, return_counts=True)
    order = np.argsort(votes, kind="stable")
    at, part = np.divmod(pairs[order], parts.count)
    shown = np.zeros(rows * columns, np.int32)
    shown[at] = part
    count = np.bincount(shown, minlength=parts.count)
    first = np.unique(labels.reshape(-1), return_index=True)
    places = tuple(
        (int(number), int(count[number]), divmod(int(index), labels.shape[1]))
        for number, index in zip(*first, strict=True)
    )
    return Shown(places, _kept(labels, shown.reshape(rows, columns)[np.ix_(down, right)], cell))


def _kept(labels: np.ndarray, shown: np.ndarray, cell: float) -> float:
    import cv2

    borders, drawn = _borders(labels), _borders(shown)
    if not borders.any():
        return 1.0
    if not drawn.any():
        return 0.0
    with plain_opencv():
        far = np.asarray(cv2.distanceTransform((~drawn).view(np.uint8), cv2.DIST_L2, cv2.DIST_MASK_5))
    return float((far[borders] <= cell + 1).mean())


def _borders(labels: np.ndarray) -> np.ndarray:
    found = np.zeros(labels.shape, np.bool_)
    found[:, 1:] |= labels[:, 1:] != labels[:, :-1]
    found[1:] |= labels[1:] != labels[:-1]
    return found
