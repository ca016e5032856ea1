"""The borders between labels as lines: from the stairs of cells to the smooth lines that such stairs may come from."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float64, Int32, Int64

BLUR, PASSES, ROUNDS = 128, 5, 8
"""Averages of neighbours that make a Gaussian of 8 steps of a line; Gaussians in a low-pass; how often that is clipped
to the half cell in which a line is known. As heights that came in steps are made smooth (`surface.dequantise`)."""

Points = Float64[np.ndarray, "n 2"]
Lanes = Float64[np.ndarray, "2 n"]
"""Points, column by column: neighbours are then taken in a third of the time."""


class Borders(NamedTuple):
    """Lines between labels, as points that have up to two neighbours."""

    at: Points
    """(column, row) in cells, the first cell's centre at (0, 0); one for each side of a cell between two labels."""
    neighbours: Int64[np.ndarray, "n 2"]
    """Which points come before and after each, itself where the line ends: at the rim, or where three labels meet."""


def border_lines(labels: Int32[np.ndarray, "h w"]) -> Borders:
    """The lines between the labels. Each of their points lies within half a cell of the side that it is of.

    The sides of cells are stairs, within half a cell of which the border lies. Of the lines there a smooth one is
    sought: low-passed along each line and clipped to the half cells, in turn. The low-pass is 1 - (1 - G)^5, which
    draws no circle together. So a straight border is straight at any angle, and corners are kept within half a cell.
    Source: projections onto convex sets (Youla & Webb, IEEE Trans. Medical Imaging 1, 1982).
    """
    points, neighbours = _sides(labels)
    at = lanes = np.ascontiguousarray(points.T)
    for _ in range(ROUNDS if len(points) else 0):
        at = np.clip(_low_pass(at, neighbours), lanes - 0.5, lanes + 0.5)
    return Borders(np.ascontiguousarray(at.T), neighbours)


def _low_pass(at: Lanes, neighbours: Int64[np.ndarray, "n 2"]) -> Lanes:
    ends = neighbours == np.arange(len(neighbours))[:, None]
    loose = ends.any(axis=1)
    before, after = (np.where(loose, np.arange(len(neighbours)), side) for side in neighbours.T)
    residual = at
    for _ in range(PASSES):
        residual = residual - _blur(residual, before, after)
    return at - residual


def _blur(at: Lanes, before: Int64[np.ndarray, "n"], after: Int64[np.ndarray, "n"]) -> Lanes:
    """Averaged with the neighbours; where a line ends, it stays."""
    for _ in range(BLUR):
        mean = at.take(before, axis=1)
        mean += at.take(after, axis=1)
        mean *= 0.5
        mean += at
        mean *= 0.5
        at = mean
    return at


def _sides(labels: Int32[np.ndarray, "h w"]) -> tuple[Points, Int64[np.ndarray, "n 2"]]:
    """The middles of the sides of cells that lie between two labels, and the neighbours of each along the line.

    Two sides are neighbours where they alone meet at a corner of cells; where three or four meet, lines end.
    """
    columns = labels.shape[1]
    upright, level = np.argwhere(labels[:, 1:] != labels[:, :-1]), np.argwhere(labels[1:] != labels[:-1])
    at = np.vstack([upright[:, ::-1] + [0.5, 0.0], level[:, ::-1] + [0.0, 0.5]]) if len(upright) + len(level) else None
    if at is None:
        return np.zeros((0, 2)), np.zeros((0, 2), np.int64)
    corner = columns + 1
    (row, column), (row_level, column_level) = upright.T, level.T
    first = np.concatenate([row * corner + column + 1, (row_level + 1) * corner + column_level])
    last = np.concatenate([(row + 1) * corner + column + 1, (row_level + 1) * corner + column_level + 1])
    ends = np.stack([first, last], axis=1)
    neighbours = np.repeat(np.arange(len(at))[:, None], 2, axis=1)
    _, which, counts = np.unique(ends.ravel(), return_inverse=True, return_counts=True)
    order = np.argsort(which.ravel(), kind="stable")
    starts = np.searchsorted(which.ravel()[order], np.flatnonzero(counts == 2))
    one, other = order[starts], order[starts + 1]
    neighbours.ravel()[one], neighbours.ravel()[other] = other // 2, one // 2
    return at, neighbours
