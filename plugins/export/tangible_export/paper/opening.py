"""Parts so far apart that their outlines, which are as wide as they are, leave room for a finger between them."""

import logging

import cv2
import numpy as np
from jaxtyping import Bool, Float64, Int32, Integer
from scipy.ndimage import distance_transform_edt, find_objects

from tangible_core.data import PartMap, SegmentMap, Work
from tangible_core.legibility.widths import measure
from tangible_core.parts import find_parts, reduced_parts
from tangible_core.plugins.notes import note

from ..labels import label_of, some
from .sheet import GAP_MM, LINE_MM

log = logging.getLogger(__name__)

PITCH_M = 0.25e-3
"""Of the cells of borders, about."""
COARSE = 2
"""Cells in which places are given away are so many times as large."""
GAP_M = (GAP_MM + LINE_MM) / 1000
"""Between the middles of two outlines."""
AMPLE = 1.12
"""What is opened is opened a little further, so that smoothed borders keep the gap."""
ROUNDS = 16
FURTHER = 0.1
"""Of the gap: so far around a narrow place all is given anew, and in each round from the third on as much farther, for
two parts may take a place from each other in turns."""
WIDER = 0.25
"""The same, where a drawn page was found too narrow at a place."""
VOTING = 0.25
"""Standard deviation of the Gaussian in which the cells around have a say, of the gap."""


def parted(work: Work, parts: PartMap, width_m: float) -> PartMap:
    """The parts, where they are less wide than GAP_M without that place, which goes to their neighbours."""
    rows, columns = parts.labels.shape
    step = max(1, round(PITCH_M / (width_m / columns)))
    fine = reduced_parts(parts, (-(-rows // step), -(-columns // step))).labels
    pitch_m = step * width_m / columns
    before = np.ascontiguousarray(fine[::COARSE, ::COARSE])
    after = _opened(before, COARSE * pitch_m)
    changed, given = (_enlarged(each, fine.shape) for each in (before != after, after))
    found = np.where(changed, given, fine)
    found = _without_crumbs(found, pitch_m)
    _say_gone(work, fine, found, parts.count)
    return PartMap(found, parts.segments)


def _enlarged(cells: Integer[np.ndarray, "r c"] | Bool[np.ndarray, "r c"], shape: tuple[int, ...]) -> np.ndarray:
    return cells.repeat(COARSE, 0).repeat(COARSE, 1)[: shape[0], : shape[1]]


def opened_at(parts: PartMap, places: Float64[np.ndarray, "n 2"], width_m: float, further: int) -> PartMap:
    """The parts, without what is too narrow at these places.

    places: as shares of the width, from the upper left corner. further: from 1 on, by how much more than that.
    """
    rows, columns = parts.labels.shape
    pitch_m, narrow = width_m / columns, np.zeros((rows, columns), np.bool_)
    at = (places * columns).astype(np.int64)
    narrow[at[:, 1].clip(0, rows - 1), at[:, 0].clip(0, columns - 1)] = True
    around = (0.5 + WIDER * further) * GAP_M / pitch_m
    found = _given_away(parts.labels, narrow, around, around / 2)  # so that all around has a say in the middle
    return PartMap(_without_crumbs(found, pitch_m), parts.segments)


def _opened(labels: Int32[np.ndarray, "h w"], pitch_m: float) -> Int32[np.ndarray, "h w"]:
    for turn in range(ROUNDS):
        widths = measure(labels, pitch_m, AMPLE * GAP_M, quick=True)
        narrow = widths.narrow | (widths.disc_m < GAP_M)[widths.pieces]
        if not narrow.any() or narrow.all():
            break
        labels = _given_away(labels, narrow, FURTHER * max(1, turn) * GAP_M / pitch_m, VOTING * GAP_M / pitch_m)
    return labels


def _given_away(
    labels: Int32[np.ndarray, "h w"], narrow: Bool[np.ndarray, "h w"], further: float, sigma: float
) -> Int32[np.ndarray, "h w"]:
    """All cells so near to a narrow place, to the part that has the most of what is around them."""
    away = cv2.distanceTransform((~narrow).astype(np.uint8), cv2.DIST_L2, 5) <= further
    given, reach = labels.copy(), int(4 * sigma) + 2
    for box in find_objects(cv2.connectedComponents(away.astype(np.uint8), connectivity=8)[1]):
        window = tuple(slice(max(0, each.start - reach), each.stop + reach) for each in box)
        given[window] = _voted(labels[window], away[window], sigma)
    return given


def _voted(labels: Int32[np.ndarray, "h w"], away: Bool[np.ndarray, "h w"], sigma: float) -> Int32[np.ndarray, "h w"]:
    numbers = np.unique(labels[~away])
    if not numbers.size:
        return labels
    says = [cv2.GaussianBlur(((labels == each) & ~away).astype(np.float32), (0, 0), sigma) for each in numbers]
    most = np.stack(says)
    nearest = np.asarray(distance_transform_edt(away, return_distances=False, return_indices=True))
    voted = np.where(most.max(axis=0) > 1e-4, numbers[most.argmax(axis=0)], labels[nearest[0], nearest[1]])
    return np.where(away, voted, labels).astype(np.int32)


def _without_crumbs(labels: Int32[np.ndarray, "h w"], pitch_m: float) -> Int32[np.ndarray, "h w"]:
    """Pieces in which no disc GAP_M wide can lie, too small to be seen on coarse cells, go to what is around them."""
    pieces = find_parts(SegmentMap(labels)).labels
    small = np.bincount(pieces.ravel()) < np.pi / 4 * (GAP_M / pitch_m) ** 2
    return labels if not small.any() or small.all() else _given_away(labels, small[pieces], 0, VOTING * GAP_M / pitch_m)


def _say_gone(work: Work, before: Int32[np.ndarray, "h w"], after: Int32[np.ndarray, "h w"], count: int) -> None:
    there, left = (np.bincount(each.ravel(), minlength=count) > 0 for each in (before, after))
    if gone := [label_of(number, work) for number in np.flatnonzero(there & ~left).tolist()]:
        note(log, f"no room for {some(gone)}: narrower than {1000 * GAP_M:.1f} mm between the middles of outlines")
