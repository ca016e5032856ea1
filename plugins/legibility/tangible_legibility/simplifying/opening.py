"""Opening of parts: narrow places and small parts go to their neighbours, round by round, until none is left."""

from math import ceil
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Int32

from tangible_core.data import SegmentMap
from tangible_core.parts import SimplifyChoice
from tangible_core.runtime import cv2

from ..cells import Box, boxes, fill, vote
from ..widths import ROUND_OFF, Rims, Widths, connected_pieces, measure, surroundings
from .large import large_parts

ROUNDS = 24  # parts that fail after these are reported
MERGING_ROUND = 12  # from here whole unnamed parts merge, which narrows nothing: rounds end
# Width of the surroundings that are removed with a narrow place, in gaps: leaves no crumbs of them.
MARGIN = 1.1
# Growth of that width per round from the third on: ends rounds in which two parts exchange a place in turns.
MARGIN_GROWTH = 0.15
MAX_GROWTH = 6  # rounds after which the width no longer grows
# Share of the surface that is too small or narrow from which on, in the first round, every cell is voted on.
NOISY = 0.05
# Standard deviation of the Gaussian of the votes, in surroundings' widths; twice that if every cell is voted on.
VOTING = 3 / 16


def too_small(wide: Widths, choice: SimplifyChoice) -> Bool[np.ndarray, "n"]:
    """Test which pieces hold no disc of the required diameter."""
    return wide.disc_m < choice.part_m * (1 - ROUND_OFF)


class Opening(NamedTuple):
    """The settings of an opening."""

    choice: SimplifyChoice
    named: Bool[np.ndarray, "k"]  # True for kinds that are a part with a name
    pitch_m: float
    picture: np.ndarray | None  # for its colours

    def run(self, labels: Int32[np.ndarray, "h w"], *, rough: bool = False) -> tuple[Int32[np.ndarray, "h w"], Widths]:
        """Open the kinds of cells until nothing is too small or too narrow, or ROUNDS are over."""
        labels, whole = labels.copy(), np.s_[0 : labels.shape[0], 0 : labels.shape[1]]
        windows, exact = [whole], False
        wide = measure(labels, self.pitch_m, self.choice.gap_m, quick=True)
        for number in range(ROUNDS):
            changed = np.zeros(labels.shape, np.bool_)
            for window in windows:
                rims = Rims(*(at == to for at, to in zip(_ends(window), _ends(whole), strict=True)))
                if number:
                    wide = measure(labels[window], self.pitch_m, self.choice.gap_m, rims, quick=not exact)
                if window == whole and too_small(wide, self.choice).all():
                    labels[:] = self._merge_alike(labels)
                    changed[:] = len(wide.part) > 1
                    break
                if window == whole and number >= MERGING_ROUND:
                    changed |= self._merge_narrow(labels, wide)
                removed = self._find_removed(wide, rims, number) & ~changed[window]
                if removed.any():
                    labels[window] = self._reassign(labels[window], removed, number)
                    changed[window] |= removed
            if not changed.any() and (rough or exact):
                return labels, wide
            exact = not changed.any()
            windows = [whole] if exact or number >= MERGING_ROUND - 1 else self._windows(changed)
        return labels, measure(labels, self.pitch_m, self.choice.gap_m)

    def _margin(self, number: int) -> float:
        return MARGIN + MARGIN_GROWTH * min(max(0, number - 2), MAX_GROWTH)

    def _find_removed(self, wide: Widths, rims: Rims, number: int) -> Bool[np.ndarray, "h w"]:
        small = too_small(wide, self.choice)
        for side in rims.open_sides():
            small[wide.pieces[side]] = False
        removed = small[wide.pieces]
        return (
            removed | surroundings(wide, self.pitch_m, self._margin(number) * self.choice.gap_m)
            if wide.places
            else removed
        )

    def _reassign(
        self, labels: Int32[np.ndarray, "h w"], removed: Bool[np.ndarray, "h w"], number: int
    ) -> Int32[np.ndarray, "h w"]:
        if removed.all():
            return labels
        sigma = VOTING * self._margin(number) * self.choice.gap_m / self.pitch_m
        if not sigma:
            return self._remove_crumbs(fill(labels, removed))
        if number or removed.mean() < NOISY:
            return self._remove_crumbs(vote(labels, removed, ~removed, sigma))
        everywhere = np.ones_like(removed)
        return self._remove_crumbs(vote(labels, everywhere, everywhere, 2 * sigma))

    def _remove_crumbs(self, labels: Int32[np.ndarray, "h w"]) -> Int32[np.ndarray, "h w"]:
        """Give pieces with less area than the required disc to the nearest cell, except at the rim."""
        pieces = connected_pieces(labels)
        size = np.bincount(pieces.reshape(-1))
        large = size >= np.pi / 4 * (self.choice.part_m / self.pitch_m) ** 2
        large[np.concatenate([pieces[0], pieces[-1], pieces[:, 0], pieces[:, -1]])] = True
        return labels if large.all() else fill(labels, ~large[pieces])

    def _merge_narrow(self, labels: Int32[np.ndarray, "h w"], wide: Widths) -> Bool[np.ndarray, "h w"]:
        """Merge each unnamed piece with a narrow place into its neighbour there, once; return its cells."""
        merger_cells, partners = np.zeros(labels.shape, np.bool_), set[int]()
        places = connected_pieces(np.where(wide.narrow, wide.pieces + 1, 0).astype(np.int32))
        for place in wide.places:
            own = place.piece
            ring = cv2.dilate((places == places[place.at]).view(np.uint8), np.ones((3, 3), np.uint8)).view(np.bool_)
            neighbours = wide.pieces[ring & (wide.pieces != own)]
            if self.named[wide.part[own]] or not neighbours.size or own in partners:
                continue
            other = int(np.bincount(neighbours).argmax())
            if other not in partners:
                partners |= {own, other}
                labels[wide.pieces == own] = wide.part[other]
                merger_cells |= wide.pieces == own
        return merger_cells

    def _merge_alike(self, labels: Int32[np.ndarray, "h w"]) -> Int32[np.ndarray, "h w"]:
        """Merge neighbours most alike in colour until each piece is large enough; for parts all of which are small."""
        shape = labels.shape
        blank = np.zeros((*shape, 3), np.uint8)
        picture = blank if self.picture is None else cv2.resize(self.picture, shape[::-1])
        large = large_parts(SegmentMap(labels), picture, self.choice.part_m / self.pitch_m, labels.size)
        count = int(labels.max()) + 1
        pairs, sizes = np.unique(large.labels.astype(np.int64) * count + labels, return_counts=True)
        piece, kind = np.divmod(pairs[np.argsort(sizes, kind="stable")], count)
        kind_of = np.zeros(large.count, np.int32)
        kind_of[piece] = kind
        return kind_of[large.labels]

    def _windows(self, changed: Bool[np.ndarray, "h w"]) -> list[Box]:
        """Return boxes around changes, with a margin of the larger bound; boxes that touch become one."""
        margin = ceil(max(self.choice.gap_m, self.choice.part_m) / self.pitch_m)
        near, windows = changed, list[Box]()
        while True:
            before = len(windows)
            pieces = cv2.connectedComponents(near.view(np.uint8), connectivity=8)[1]
            windows = [_grow(box, margin, near.shape) for box in boxes(pieces) if box is not None]
            if len(windows) == before:
                return windows
            near, margin = np.zeros_like(changed), 0
            for box in windows:
                near[box] = True


def _grow(box: Box, margin: int, shape: tuple[int, ...]) -> Box:
    down, right = (
        slice(max(0, each.start - margin), min(size, each.stop + margin)) for each, size in zip(box, shape, strict=True)
    )
    return down, right


def _ends(window: Box) -> tuple[int, int, int, int]:
    down, right = window
    return down.start, down.stop, right.start, right.stop
