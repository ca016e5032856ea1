"""Parts merged and opened until fingers can read them."""

import logging
from collections.abc import Sequence
from math import ceil
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Int32

from ...data import PartMap, SegmentMap
from ...parts import find_parts
from ...parts.large import large_parts
from ...plugins.notes import note
from ..cells import Box, boxes, filled, voted
from ..grid import Grid, on_grid
from ..widths import ROUND_OFF, Rims, Widths, around, connected, measure
from ..words import called, listed, mm
from .choice import SimplifyChoice
from .textures import kinds_of

log = logging.getLogger(__name__)

ROUNDS, WHOLE_FROM = 24, 12
"""Rounds, and the first in which a part without a name that is still too narrow somewhere becomes one with the part
beside it there: nothing else gets narrower by that, so that it ends."""
FURTHER = 1.1
"""So much wider than a place that is too narrow is what goes with it, so that no crumbs of it stay,"""
FURTHER_YET = 0.15
"""and so much more in each further round, in which two parts may take a place from each other in turns."""
NOISY = 0.05
"""Share of the surface from which on, if so much is too small or too narrow, all of it is voted on first."""
VOTING = 3 / 16
"""Standard deviation of the Gaussian in which the cells around vote, of the gap; twice that where all is voted on."""
WIDER, WIDEST = 1.1, 40
"""By how much a size is tried that would do, and how often."""
WINDOW = 1.0
"""Around what has changed, so many gaps and parts are looked at again."""
COARSE = 2
"""Most is done on cells so many times as large."""
SURELY = 0.8
"""Of what is asked for: what is less on such cells, is less."""


def simplify(
    parts: PartMap,
    width_m: float,
    choice: SimplifyChoice,
    names: Sequence[str] = (),
    picture: np.ndarray | None = None,
) -> PartMap:
    """The parts as fingers can read them, on a grid of its own, with the numbers that they have.

    Parts that pass stay as they are, on the grid of `on_grid`: so twice is the same as once. Else, on cells of an
    eighth to a quarter of a millimetre, parts without a name that are most alike in colour become one texture until
    there are `choice.textures`; then places narrower than `choice.gap_m` and parts that hold no disc of
    `choice.part_m` go to the parts around them, again and again until all passes. A part that vanished has no pixel.
    Parts that became one texture have one segment.
    names: of parts, by number; those that have one stay apart. picture: of the parts' size, for its colours.
    Notes tell which named parts vanished, which are of several pieces, and, where it cannot pass, what would help.
    Raises: GeometryError if width_m is not positive.
    """
    grid = on_grid(parts, width_m, worked=True)
    coarse = _coarse(grid.parts.labels)
    before = measure(coarse, COARSE * grid.pitch_m, choice.gap_m, quick=True)
    if not _surely_wrong(grid.parts, before, COARSE * grid.pitch_m, choice, names):
        whole = on_grid(parts, width_m)
        if not _wrong(whole.parts, measure(whole.parts.labels, whole.pitch_m, choice.gap_m), choice, names):
            return whole.parts
    kinds = kinds_of(grid.parts, names, choice.textures, picture)
    named = np.zeros(int(kinds.max()) + 1, np.bool_)
    named[[kind for kind, name in zip(kinds.tolist(), names, strict=False) if name]] = True
    opening = _Opening(choice, named)
    found = kinds[grid.parts.labels]
    rough, _ = opening.opened(kinds[coarse], COARSE * grid.pitch_m, picture, rough=True)
    changed = _fine(rough != kinds[coarse], found.shape)
    found, after = opening.opened(np.where(changed, _fine(rough, found.shape), found), grid.pitch_m, picture)
    made = Grid(_numbered(grid.parts, found, kinds), grid.pitch_m)
    _tell(grid.parts, made, after, width_m, choice, names)
    return made.parts


def _coarse(labels: Int32[np.ndarray, "h w"]) -> Int32[np.ndarray, "r c"]:
    """One cell of each few, in which most is soon done."""
    return np.ascontiguousarray(labels[::COARSE, ::COARSE])


def _fine(coarse: np.ndarray, shape: tuple[int, int]) -> np.ndarray:
    return coarse.repeat(COARSE, 0).repeat(COARSE, 1)[: shape[0], : shape[1]]


def textures_of(parts: PartMap, names: Sequence[str] = ()) -> int:
    """How many textures the parts that are there have: one a segment, but for those that a name tells apart."""
    there = np.flatnonzero(np.bincount(parts.labels.reshape(-1), minlength=parts.count))
    return len({parts.segments[n] for n in there.tolist() if n >= len(names) or not names[n]})


class _Wrong(NamedTuple):
    small: int
    narrow: int
    textures: int


def _surely_wrong(parts: PartMap, wide: Widths, pitch_m: float, choice: SimplifyChoice, names: Sequence[str]) -> bool:
    """Whether it does not pass by so much that a coarse look tells."""
    small = wide.size[wide.disc_m < SURELY * choice.part_m].sum() > NOISY * wide.size.sum()
    large = 2 * (choice.gap_m / pitch_m) ** 2
    narrow = any(place.width_m < SURELY * choice.gap_m and place.size > large for place in wide.places)
    return bool(small) or narrow or textures_of(parts, names) > choice.textures


def _wrong(parts: PartMap, wide: Widths, choice: SimplifyChoice, names: Sequence[str]) -> _Wrong | None:
    """What does not pass; None where all does."""
    small = int(np.count_nonzero(_small(wide, choice)))
    found = _Wrong(small, len(wide.places), max(0, textures_of(parts, names) - choice.textures))
    return found if any(found) else None


def _small(wide: Widths, choice: SimplifyChoice) -> Bool[np.ndarray, "n"]:
    return wide.disc_m < choice.part_m * (1 - ROUND_OFF)


class _Opening(NamedTuple):
    """What parts are opened by."""

    choice: SimplifyChoice
    named: Bool[np.ndarray, "k"]
    """Which kinds are parts that have a name."""

    def opened(
        self, found: Int32[np.ndarray, "h w"], pitch_m: float, picture: np.ndarray | None, *, rough: bool = False
    ) -> tuple[Int32[np.ndarray, "h w"], Widths]:
        """Once nothing is too small or too narrow, or the rounds are over; and the widths then.

        After the first round only what is around the changes is looked at, and in the end everything once more, and
        exactly. found: the kind of each cell. rough: not once more.
        """
        whole = np.s_[0 : found.shape[0], 0 : found.shape[1]]
        windows, exactly, found = [whole], False, found.copy()
        wide = measure(found, pitch_m, self.choice.gap_m, quick=True)
        for turn in range(ROUNDS):
            changed = np.zeros(found.shape, np.bool_)
            for window in windows:
                rims = Rims(*(at == to for at, to in zip(_ends(window), _ends(whole), strict=True)))
                if turn:
                    wide = measure(found[window], pitch_m, self.choice.gap_m, rims, quick=not exactly)
                if window == whole and _small(wide, self.choice).all():
                    found = _joined(found, self.choice.part_m / pitch_m, picture)
                    changed[:] = len(wide.part) > 1
                    break
                if turn >= WHOLE_FROM and wide.places and window == whole:
                    found, merged = self._merged(found, wide)
                    changed |= merged
                away = self._away(wide, pitch_m, rims, turn) & ~changed[window]
                if away.any():
                    found[window] = self._given(found[window], away, pitch_m, turn)
                    changed[window] |= away
            if changed.any():
                windows, exactly = self._windows(changed, pitch_m), False
                windows = windows if turn < WHOLE_FROM - 1 else [whole]
            elif rough or exactly:
                return found, wide
            else:
                windows, exactly = [whole], True
        return found, measure(found, pitch_m, self.choice.gap_m)

    def _away(self, wide: Widths, pitch_m: float, rims: Rims, turn: int) -> Bool[np.ndarray, "h w"]:
        """Cells that are to be given to what is around them."""
        gone = _small(wide, self.choice)
        for side in rims.open_sides():
            gone[wide.pieces[side]] = False
        found = gone[wide.pieces]
        return found | around(wide, pitch_m, self._further(turn) * self.choice.gap_m) if wide.places else found

    def _merged(
        self, found: Int32[np.ndarray, "h w"], wide: Widths
    ) -> tuple[Int32[np.ndarray, "h w"], Bool[np.ndarray, "h w"]]:
        """Parts without a name that are too narrow somewhere, given as a whole to the part beside it there."""
        import cv2

        found, merged, taken = found.copy(), np.zeros(found.shape, np.bool_), set[int]()
        places = connected(np.where(wide.narrow, wide.pieces + 1, 0).astype(np.int32))
        for place in wide.places:
            own = place.piece
            ring = cv2.dilate((places == places[place.at]).view(np.uint8), np.ones((3, 3), np.uint8)).view(np.bool_)
            beside = wide.pieces[ring & (wide.pieces != own)]
            if self.named[wide.part[own]] or not beside.size or own in taken:
                continue
            other = int(np.bincount(beside).argmax())
            if other not in taken:
                taken |= {own, other}
                found[wide.pieces == own] = wide.part[other]
                merged |= wide.pieces == own
        return found, merged

    def _given(
        self, found: Int32[np.ndarray, "h w"], away: Bool[np.ndarray, "h w"], pitch_m: float, turn: int
    ) -> Int32[np.ndarray, "h w"]:
        sigma = VOTING * self._further(turn) * self.choice.gap_m / pitch_m
        if away.all():
            return found
        if turn or away.mean() < NOISY:
            given = voted(found, away, ~away, sigma) if sigma else filled(found, away)
        else:
            given = voted(found, np.ones_like(away), np.ones_like(away), 2 * sigma) if sigma else filled(found, away)
        return self._without_crumbs(given, pitch_m)

    def _further(self, turn: int) -> float:
        return FURTHER + FURTHER_YET * min(max(0, turn - 2), 6)

    def _without_crumbs(self, found: Int32[np.ndarray, "h w"], pitch_m: float) -> Int32[np.ndarray, "h w"]:
        """Pieces with less area than a disc that is large enough are given to what is nearest."""
        pieces = connected(found)
        size = np.bincount(pieces.reshape(-1))
        large = size >= np.pi / 4 * (self.choice.part_m / pitch_m) ** 2
        large[np.concatenate([pieces[0], pieces[-1], pieces[:, 0], pieces[:, -1]])] = True
        return found if large.all() else filled(found, ~large[pieces])

    def _windows(self, changed: Bool[np.ndarray, "h w"], pitch_m: float) -> list[Box]:
        """Boxes around what has changed; those that meet are one."""
        cells = ceil(WINDOW * max(self.choice.gap_m, self.choice.part_m) / pitch_m)
        near = changed
        found: list[Box] = []
        while True:
            before, found = found, [_grown(box, cells, near) for box in boxes(_blobs(near)) if box is not None]
            if len(found) == len(before):
                return found
            near, cells = np.zeros_like(changed), 0
            for box in found:
                near[box] = True


def _blobs(there: Bool[np.ndarray, "h w"]) -> Int32[np.ndarray, "h w"]:
    import cv2

    return cv2.connectedComponents(there.view(np.uint8), connectivity=8)[1]


def _grown(box: Box, cells: int, within: Bool[np.ndarray, "h w"]) -> Box:
    down, right = (
        slice(max(0, each.start - cells), min(size, each.stop + cells))
        for each, size in zip(box, within.shape, strict=True)
    )
    return down, right


def _ends(window: Box) -> tuple[int, int, int, int]:
    down, right = window
    return down.start, down.stop, right.start, right.stop


def _joined(found: Int32[np.ndarray, "h w"], least_px: float, picture: np.ndarray | None) -> Int32[np.ndarray, "h w"]:
    """Where no piece is large enough: neighbours most alike in colour become one until all that are left are."""
    import cv2

    shape = found.shape
    seen = np.zeros((*shape, 3), np.uint8) if picture is None else cv2.resize(picture, shape[::-1])
    large = large_parts(SegmentMap(found), seen, least_px, found.size)
    count = int(found.max()) + 1
    pairs, sizes = np.unique(large.labels.astype(np.int64) * count + found, return_counts=True)
    order = np.argsort(sizes, kind="stable")
    piece, kind = np.divmod(pairs[order], count)
    of = np.zeros(large.count, np.int32)
    of[piece] = kind
    return of[large.labels]


def _numbered(parts: PartMap, found: Int32[np.ndarray, "h w"], kinds: Int32[np.ndarray, "n"]) -> PartMap:
    """Each piece with the number of the part, of those of its kind, that most of it was; the largest where it was none.

    Segments are those of the largest part of each kind.
    """
    before, count = parts.labels, parts.count
    size = np.bincount(before.reshape(-1), minlength=count)
    largest = np.zeros(int(kinds.max()) + 1, np.int64)
    by_size = np.argsort(size, kind="stable")
    largest[kinds[by_size]] = by_size
    pieces = find_parts(SegmentMap(found))
    same = kinds[before] == found
    pairs, shared = np.unique(pieces.labels[same].astype(np.int64) * count + before[same], return_counts=True)
    piece, part = np.divmod(pairs, count)
    order = np.lexsort((-part, shared))
    number = largest[np.array(pieces.segments)]
    number[piece[order]] = part[order]
    of: list[int] = largest[kinds].tolist()
    segments = tuple(parts.segments[each] for each in of)
    return PartMap(number.astype(np.int32)[pieces.labels], segments)


def _tell(
    whole: PartMap,
    found: Grid,
    after: Widths,
    width_m: float,
    choice: SimplifyChoice,
    names: Sequence[str],
) -> None:
    """Note which named parts vanished, which parts are of several pieces, and whether it passes."""
    count = whole.count
    was, left = (np.bincount(each.labels.reshape(-1), minlength=count) for each in (whole, found.parts))
    gone = [n for n in np.flatnonzero((was > 0) & (left == 0)).tolist() if n < len(names) and names[n]]
    if gone:
        note(log, _vanished(gone, Grid(whole, found.pitch_m), width_m, choice, names), logging.WARNING)
    there = found.parts.labels.reshape(-1)[np.unique(after.pieces.reshape(-1), return_index=True)[1]]
    pieces = np.bincount(there, minlength=count)
    if split := [f"{called(n, names)} of {pieces[n]}" for n in np.flatnonzero(pieces > 1).tolist()]:
        note(log, f"simplified, these parts are of several pieces: {listed(split)}")
    if wrong := _wrong(found.parts, after, choice, names):
        note(log, _failed(wrong, found, width_m, choice), logging.WARNING)


def _vanished(gone: Sequence[int], whole: Grid, width_m: float, choice: SimplifyChoice, names: Sequence[str]) -> str:
    before = measure(whole.parts.labels, whole.pitch_m, choice.gap_m)
    disc_m = np.zeros(whole.parts.count)
    np.maximum.at(disc_m, before.part, before.disc_m)
    small = disc_m < choice.part_m * (1 - ROUND_OFF)
    said = [
        f"{called(n, names)}, "
        + (f"in which a disc of {mm(float(disc_m[n]))} fits" if small[n] else "which is too narrow in places")
        for n in gone
    ]
    wider = max(1.05, choice.part_m / float(disc_m[list(gone)].min()))
    return (
        f"too small or too narrow for a finger, and given to what is around: {listed(said)}; a disc of "
        f"{mm(choice.part_m)} must fit, and {mm(choice.gap_m)} are needed everywhere: make the whole "
        f"{ceil(1e3 * wider * width_m)} mm wide (`workspace.width_m`), or have fewer and larger parts"
    )


def _failed(wrong: _Wrong, found: Grid, width_m: float, choice: SimplifyChoice) -> str:
    """What still fails, and the size that would do: tried, in steps of a tenth."""
    kinds = (
        (wrong.small, f"{wrong.small} too small"),
        (wrong.narrow, f"{wrong.narrow} places too narrow"),
        (wrong.textures, f"{wrong.textures} textures too many"),
    )
    said = listed([text for count, text in kinds if count])
    times = 0.0 if wrong.textures else wide_enough(found, choice.gap_m, choice.part_m)
    cure = f"{mm(width_m * times)} wide they would pass, or " if times else ""
    return f"fingers cannot read the parts as they are simplified ({said}); {cure}have fewer and larger parts"


def wide_enough(grid: Grid, gap_m: float, part_m: float) -> float:
    """By how much the whole must grow for all to be large and wide enough: tried, in steps of a tenth; 0 for never."""
    for times in (WIDER**step for step in range(WIDEST)):
        wide = measure(grid.parts.labels, grid.pitch_m * times, gap_m)
        if not wide.places and (wide.disc_m >= part_m * (1 - ROUND_OFF)).all():
            return times
    return 0.0
