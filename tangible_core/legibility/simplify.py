"""Parts merged and opened until fingers can read them."""

import logging
from collections.abc import Sequence

import numpy as np
from jaxtyping import Bool, Float64, Int, Int32

from ..data import PartMap, SegmentMap
from ..parts import find_parts
from ..plugins.notes import note
from ..runtime.opencv import plain_opencv
from .choice import SimplifyChoice
from .grid import Grid, on_grid
from .widths import Widths, measure

log = logging.getLogger(__name__)

ROUNDS = 12
AMPLE = 1.03
"""What is opened is opened a little further than must be, so that what is left passes."""
SMOOTHED = 3 / 8
"""Standard deviation of the Gaussian in which parts vote on a cell, of the gap."""


def simplify(
    parts: PartMap,
    width_m: float,
    choice: SimplifyChoice,
    names: Sequence[str] = (),
    picture: np.ndarray | None = None,
) -> PartMap:
    """The parts as fingers can read them, with the numbers that they have.

    Raises: GeometryError if width_m is not positive.
    """
    whole = on_grid(parts, width_m)
    if _passes(whole, choice, names):
        return whole.parts
    grid = on_grid(parts, width_m, worked=True)
    kinds = _kinds(grid.parts, names, choice.textures, picture)
    found = kinds[grid.parts.labels]
    for _ in range(ROUNDS):
        wide = measure(PartMap(found, tuple(range(int(kinds.max()) + 1))), grid.pitch_m, choice.gap_m * AMPLE)
        small = wide.disc_m < choice.part_m
        if not small.any() and not wide.places:
            break
        if small.all():
            break
        away = small[wide.pieces] | wide.narrow
        found = _filled(found, away)
    return _numbered(grid, found, kinds)


def _passes(grid: Grid, choice: SimplifyChoice, names: Sequence[str]) -> bool:
    if textures_of(grid.parts, names) > choice.textures:
        return False
    wide = measure(grid.parts, grid.pitch_m, choice.gap_m)
    return not wide.places and bool((wide.disc_m >= choice.part_m * (1 - 1e-6)).all())


def textures_of(parts: PartMap, names: Sequence[str]) -> int:
    """How many textures the parts have that are there: one a segment, but for parts that a name tells apart."""
    there = np.flatnonzero(np.bincount(parts.labels.reshape(-1), minlength=parts.count))
    return len({parts.segments[n] for n in there.tolist() if not _name(names, n)})


def _name(names: Sequence[str], number: int) -> str:
    return names[number] if number < len(names) else ""


def _kinds(parts: PartMap, names: Sequence[str], textures: int, picture: np.ndarray | None) -> Int32[np.ndarray, "n"]:
    """The kind of each part: parts of one kind that touch are one."""
    said = [f"name {n}" if _name(names, n) else f"segment {parts.segments[n]}" for n in range(parts.count)]
    order = {each: at for at, each in enumerate(dict.fromkeys(said))}
    return np.array([order[each] for each in said], np.int32)


def _filled(labels: Int32[np.ndarray, "h w"], away: Bool[np.ndarray, "h w"]) -> Int32[np.ndarray, "h w"]:
    """What is to go is of the nearest that stays."""
    import cv2

    if not away.any() or away.all():
        return labels
    with plain_opencv():
        _, nearest = cv2.distanceTransformWithLabels(
            away.view(np.uint8), cv2.DIST_L2, cv2.DIST_MASK_5, labelType=cv2.DIST_LABEL_PIXEL
        )
    stays = ~away
    of = np.zeros(int(nearest.max()) + 1, np.int32)
    of[nearest[stays]] = labels[stays]
    return of[nearest]


def _numbered(grid: Grid, found: Int32[np.ndarray, "h w"], kinds: Int32[np.ndarray, "n"]) -> PartMap:
    """With the number of the part, of those of the same kind, that most of each piece was."""
    pieces = find_parts(SegmentMap(found))
    before = grid.parts.labels
    same = kinds[before] == found
    count = grid.parts.count
    pairs, sizes = np.unique(pieces.labels[same].astype(np.int64) * count + before[same], return_counts=True)
    piece, part = np.divmod(pairs, count)
    first = np.array([int(np.flatnonzero(kinds == kind)[0]) for kind in pieces.segments])
    order = np.lexsort((-part, sizes))
    first[piece[order]] = part[order]
    return PartMap(first.astype(np.int32)[pieces.labels], grid.parts.segments)
