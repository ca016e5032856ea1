"""Dashed and dotted lines: rows of short strokes or dots of even size and with even gaps."""
# scipy has no types.
# pyright: reportMissingTypeStubs=false, reportUnknownVariableType=false, reportUnknownMemberType=false
# pyright: reportAttributeAccessIssue=false, reportUnknownArgumentType=false

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float64, Int32

from ..runtime.opencv import cv2, plain_opencv
from .ink import Ink

LONGEST = 1 / 12  # the greatest length of a dash, as a share of the longer side
DOT = 1.7  # the ratio of length to width below which a dash is a dot, which has no direction
# The least and greatest width of a dash, by that of the rectangle of the same second moments; letters are less filled.
FILLED = (0.6, 1.25)
WIDER = 1.6  # the greatest ratio of the widths of two neighbours
GAP, LONG_GAP = 5.0, 1.2  # the greatest gap, by the line's width or, where that is more, by the length of a dash
REACH = 2.5  # how much farther the next dash may lie, since a line may cross one in between
BEND_DEG, TURN_DEG = 36.0, 50.0  # the greatest turn from a dash to the way to the next one, and of the way at a dash
APART = 1.45  # the least distance of others by that of the nearest in the row: those of a fill are nearer
EVEN, EVEN_PX = 0.15, 0.6  # the greatest mean deviation of lengths and gaps, by their mean, and px for the grid
SURE = 8  # the least number of dashes for which the grid is allowed for: fewer may be chance
WAVE_DEG = 13.0  # the greatest mean change of the turn from one dash to the next
DASHES, DOTS = 4, 6  # the least number of dashes of a line, and of dots
MAX_PIECES, NEAR = 12_000, 12  # the most pieces that are looked at, since more are a texture; and around each of them


class DashedLine(NamedTuple):
    """A dashed or dotted line on the grid of the ink."""

    way: Float64[np.ndarray, "n 2"]  # the centre line from end to end, in steps of a pixel: column and row
    lengths_px: tuple[float, ...]  # the length of a dash; of each of a period in turn where they differ
    gap_px: float
    width_px: float

    @property
    def dots(self) -> tuple[bool, ...]:
        """Whether each dash of a period is a dot."""
        return tuple(length < DOT * self.width_px for length in self.lengths_px)


class _Pieces(NamedTuple):
    """Pieces of ink that may be dashes; directions are those of their longer axes."""

    number: np.ndarray
    middle: np.ndarray
    direction: np.ndarray
    length: np.ndarray
    width: np.ndarray


def find_dashes(ink: Ink, letters: Bool[np.ndarray, "r c"]) -> tuple[tuple[DashedLine, ...], Bool[np.ndarray, "r c"]]:
    """Return the dashed lines in ink without these letters, and the mask of their dashes."""
    with plain_opencv():
        found = np.asarray(cv2.connectedComponents((ink.mask & ~letters).astype(np.uint8), connectivity=8)[1], np.int32)
    pieces, lines = _find_pieces(found, ink.widest_px), list[DashedLine]()
    dashes = np.zeros(int(found.max()) + 1, np.bool_)
    if DASHES <= pieces.length.size <= MAX_PIECES:
        for row in _rows(_links(pieces)):
            if (line := _even_line(pieces, row)) is not None:
                lines.append(line)
                dashes[pieces.number[row]] = True
    return tuple(lines), dashes[found]


def _find_pieces(found: Int32[np.ndarray, "r c"], widest_px: int) -> _Pieces:
    """Return the pieces of ink that are filled and hardly bent, by their second moments."""
    y, x = np.nonzero(found)
    of, count = found[y, x], int(found.max()) + 1
    area = np.bincount(of, minlength=count)
    column, row, xx, yy, xy = (
        np.bincount(of, values, count) / np.maximum(area, 1) for values in (x, y, x * x, y * y, x * y)
    )
    xx, yy, xy = xx - column**2 + 1 / 12, yy - row**2 + 1 / 12, xy - column * row
    half, off = (xx + yy) / 2, np.hypot((xx - yy) / 2, xy)
    length, across = np.sqrt(12 * (half + off)), np.sqrt(12 * np.maximum(half - off, 1e-9))
    width, turn = area / length, np.arctan2(2 * xy, xx - yy) / 2
    chosen = (width >= FILLED[0] * across) & (width <= FILLED[1] * across) & (width <= widest_px)
    number = np.flatnonzero(chosen & (area > 0) & (length <= LONGEST * max(found.shape)))
    middle, direction = np.stack([column, row], axis=1), np.stack([np.cos(turn), np.sin(turn)], axis=1)
    return _Pieces(number, middle[number], direction[number], length[number], width[number])


def _links(pieces: _Pieces) -> list[list[int]]:
    """Return for each piece the nearest one on each side that is like it and in line; none where others crowd it."""
    from scipy.spatial import cKDTree

    distance, near = (
        each[:, 1:] for each in cKDTree(pieces.middle).query(pieces.middle, min(pieces.length.size, NEAR))
    )
    way = (pieces.middle[near] - pieces.middle[:, None]) / np.maximum(distance, 1e-9)[..., None]
    widths, lengths = (np.stack(np.broadcast_arrays(of[near], of[:, None])) for of in (pieces.width, pieces.length))
    like = widths.max(axis=0) <= WIDER * widths.min(axis=0) + 1
    gap = distance - lengths.mean(axis=0)
    fits = like & (gap > 0) & (gap <= REACH * np.maximum(GAP * widths.max(axis=0), LONG_GAP * lengths.max(axis=0)))
    is_dot = pieces.length <= DOT * pieces.width + 0.5
    for direction, free in ((pieces.direction[:, None], is_dot[:, None]), (pieces.direction[near], is_dot[near])):
        fits &= free | (np.abs((way * direction).sum(axis=2)) >= np.cos(np.radians(BEND_DEG)))
    links = list[list[int]]()
    for here in range(len(near)):
        ranked = np.flatnonzero(fits[here])[np.argsort(gap[here][fits[here]], kind="stable")]
        back = np.einsum("ik,jk->ij", way[here, ranked], way[here, ranked[:1]]) <= -np.cos(np.radians(TURN_DEG))
        follow = [*ranked[:1], *ranked[back.any(axis=1)][:1]]
        beside = like[here] & (distance[here] < APART * min(distance[here, follow], default=0))
        beside[follow] = False
        links.append([] if beside.any() else near[here, follow].tolist())
    return [[other for other in row if here in links[other]] for here, row in enumerate(links)]


def _rows(links: list[list[int]]) -> Iterator[list[int]]:
    """Yield the rows of linked pieces; a ring ends with its first piece."""
    seen = set[int]()
    for start in sorted(range(len(links)), key=lambda piece: len(links[piece])):
        row = [start]
        while start not in seen and (ahead := [each for each in links[row[-1]] if each not in row[-2:]]):
            row.append(ahead[0])
            if row[-1] == start:
                break
        yield row
        seen |= {*row}


def _even_line(pieces: _Pieces, row: list[int]) -> DashedLine | None:
    """Return the line of a row; None if it is not even, not smooth or too short."""
    length, width = pieces.length[row], float(np.median(pieces.width[row]))
    if len(row) < (DOTS if length.mean() < DOT * width else DASHES):
        return None
    steps, mean, inner = np.diff(pieces.middle[row], axis=0), length.mean(), length[1:-1]
    gaps, slack = np.hypot(*steps.T) - (length[1:] + length[:-1]) / 2, EVEN_PX * (len(row) >= SURE)
    gap = float(np.median(gaps))
    missing = np.rint(np.clip((gaps - gap) / (mean + gap), 0, 2)).astype(np.int64)
    turns = np.diff(np.unwrap(np.arctan2(steps[:, 1], steps[:, 0])))
    if gap > max(GAP * width, LONG_GAP * mean) or (missing > 0).mean() > 1 / 3:
        return None
    if np.abs(np.diff(turns)).mean() > np.radians(WAVE_DEG):
        return None
    for period in range(1, min(3, inner.size // 2) + 1):
        turn = (np.arange(inner.size) + np.cumsum(missing)[:-1]) % period
        lengths = [float(np.median(inner[turn == each])) for each in np.unique(turn)]
        off = (gaps - gap - missing * (mean + gap))[(missing == 0) | (period == 1)]
        even = len(lengths) == period and np.abs(inner - np.take(lengths, turn)).mean() <= EVEN * inner.mean() + slack
        if even and np.abs(off).mean() <= EVEN * gap + slack:
            return DashedLine(_way(pieces, row), tuple(lengths), gap, width)
    return None


def _way(pieces: _Pieces, row: list[int]) -> Float64[np.ndarray, "n 2"]:
    """Return a smooth curve through the middles of pieces, to the outer ends of the first and last one."""
    from scipy.interpolate import CubicSpline

    at, is_ring = pieces.middle[row], row[0] == row[-1]
    along = np.concatenate([[0], np.cumsum(np.hypot(*np.diff(at, axis=0).T))])
    before, after = (0, 0) if is_ring else pieces.length[[row[0], row[-1]]] / 2
    places = np.linspace(-before, along[-1] + after, int(along[-1] + before + after) + 2)
    return np.asarray(CubicSpline(along, at, bc_type="periodic" if is_ring else "natural")(places), np.float64)
