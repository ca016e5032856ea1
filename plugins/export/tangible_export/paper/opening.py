"""Parts opened, in the sense of morphology, so that a finger has room between their outlines."""

import logging

import cv2
import numpy as np
from jaxtyping import Bool, Float64, Int32, Integer
from scipy.ndimage import find_objects

from tangible_core.data import PartMap, SegmentMap, Work
from tangible_core.parts import find_parts, reduced_parts
from tangible_core.plugins import note
from tangible_legibility.cells import vote
from tangible_legibility.widths import measure

from .named_parts import find_label, first_labels
from .sheet import GAP_MM, LINE_MM

log: logging.Logger = logging.getLogger(__name__)

PITCH_M = 0.25e-3
COARSE = 2
GAP_M = (GAP_MM + LINE_MM) / 1000  # between the middles of two outlines
AMPLE = 1.12  # so that smoothed borders still keep the gap
ROUNDS = 16
FURTHER = 0.1
"""Margin around a narrow place that is assigned anew, as a share of the gap. From the third round on the margin grows
by as much a round, as two parts may otherwise take a place from each other in turns."""
WIDER = 0.25
VOTING = 0.25  # the standard deviation of the Gaussian by which neighbouring cells vote, as a share of the gap


def open_parts(work: Work, parts: PartMap, width_m: float) -> PartMap:
    """Return the parts without places narrower than GAP_M, which go to their neighbours."""
    rows, columns = parts.labels.shape
    step = max(1, round(PITCH_M / (width_m / columns)))
    fine = reduced_parts(parts, (-(-rows // step), -(-columns // step))).labels
    pitch_m = step * width_m / columns
    before = np.ascontiguousarray(fine[::COARSE, ::COARSE])
    after = _open(before, COARSE * pitch_m)
    is_new, coarse = (_enlarge(mask, fine.shape) for mask in (before != after, after))
    # An edge of a part may lie in the coarse cells of its neighbour: it would be left as a thread.
    near = cv2.dilate(is_new.astype(np.uint8), np.ones((2 * COARSE - 1, 2 * COARSE - 1), np.uint8)) > 0
    labels = _without_crumbs(np.where(near, coarse, fine), pitch_m)
    _note_lost(work, fine, labels, parts.count)
    return PartMap(labels, parts.segments)


def _enlarge(cells: Integer[np.ndarray, "r c"] | Bool[np.ndarray, "r c"], shape: tuple[int, ...]) -> np.ndarray:
    return cells.repeat(COARSE, 0).repeat(COARSE, 1)[: shape[0], : shape[1]]


def open_at(parts: PartMap, places: Float64[np.ndarray, "n 2"], width_m: float, further: int) -> PartMap:
    """Return the parts opened at these shares of the width; the margin grows with `further`, from 1 on."""
    rows, columns = parts.labels.shape
    pitch_m, narrow = width_m / columns, np.zeros((rows, columns), np.bool_)
    at = (places * columns).astype(np.int64)
    narrow[at[:, 1].clip(0, rows - 1), at[:, 0].clip(0, columns - 1)] = True
    around = (0.5 + WIDER * further) * GAP_M / pitch_m
    labels = _reassign(parts.labels, narrow, around, around / 2)  # so wide that all neighbours vote on the middle
    return PartMap(_without_crumbs(labels, pitch_m), parts.segments)


def _open(labels: Int32[np.ndarray, "h w"], pitch_m: float) -> Int32[np.ndarray, "h w"]:
    for turn in range(ROUNDS):
        widths = measure(labels, pitch_m, AMPLE * GAP_M, quick=True)
        narrow = widths.narrow | (widths.disc_m < GAP_M)[widths.pieces]
        if not narrow.any() or narrow.all():
            break
        labels = _reassign(labels, narrow, FURTHER * max(1, turn) * GAP_M / pitch_m, VOTING * GAP_M / pitch_m)
    return labels


def _reassign(
    labels: Int32[np.ndarray, "h w"], narrow: Bool[np.ndarray, "h w"], further: float, sigma: float
) -> Int32[np.ndarray, "h w"]:
    """Assign all cells within `further` of a narrow place to the part with the largest share of the cells around."""
    away = cv2.distanceTransform((~narrow).astype(np.uint8), cv2.DIST_L2, 5) <= further
    result, reach = labels.copy(), int(4 * sigma) + 2
    for box in find_objects(cv2.connectedComponents(away.astype(np.uint8), connectivity=8)[1]):
        window = tuple(slice(max(0, side.start - reach), side.stop + reach) for side in box)
        result[window] = vote(labels[window], away[window], ~away[window], sigma)
    return result


def _without_crumbs(labels: Int32[np.ndarray, "h w"], pitch_m: float) -> Int32[np.ndarray, "h w"]:
    """Assign pieces that are too small for a disc GAP_M wide to their neighbours; the coarse grid may miss them."""
    pieces = find_parts(SegmentMap(labels)).labels
    small = np.bincount(pieces.ravel()) < np.pi / 4 * (GAP_M / pitch_m) ** 2
    return labels if not small.any() or small.all() else _reassign(labels, small[pieces], 0, VOTING * GAP_M / pitch_m)


def _note_lost(work: Work, before: Int32[np.ndarray, "h w"], after: Int32[np.ndarray, "h w"], count: int) -> None:
    there, remaining = (np.bincount(labels.ravel(), minlength=count) > 0 for labels in (before, after))
    if lost := [find_label(number, work) for number in np.flatnonzero(there & ~remaining).tolist()]:
        note(
            log,
            f"no room for {first_labels(lost)}: narrower than {1000 * GAP_M:.1f} mm between the middles of outlines",
        )
