"""Parts on a pin display: each pin shows the part that has most of its cell."""

from typing import NamedTuple

import numpy as np

from tangible_core.data import PartMap
from tangible_core.runtime import plain_opencv

PIN_PITCH_M = 0.0025
"""Distance from pin to pin; all braille displays have about this pitch."""


class PinDisplay(NamedTuple):
    """Parts as pins show them."""

    parts: tuple[tuple[int, int, tuple[int, int]], ...]
    """(number, pins, a cell on the grid of the parts) of each part."""
    kept: float
    """Share of the length of all borders that lies within a pin of a border that is shown; 1 without a border."""


def show_on_pins(parts: PartMap, pitch_m: float) -> PinDisplay:
    """Return the pins of parts whose cells are pitch_m wide."""
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
    return PinDisplay(places, _share_of_borders(labels, shown.reshape(rows, columns)[np.ix_(down, right)], cell))


def _share_of_borders(labels: np.ndarray, shown: np.ndarray, cell: float) -> float:
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
    borders = np.zeros(labels.shape, np.bool_)
    borders[:, 1:] |= labels[:, 1:] != labels[:, :-1]
    borders[1:] |= labels[1:] != labels[:-1]
    return borders
