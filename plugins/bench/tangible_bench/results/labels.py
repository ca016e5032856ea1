"""Names beside points such that none covers another name or a point."""
# matplotlib keywords have no types.
# pyright: reportUnknownMemberType=false

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise, product
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from matplotlib.axes import Axes

RINGS_PT = (8, 18, 30, 44, 60, 80)
"""Distances from the point that are tried, near ones first."""
TURNS = 16
POINT_PT = 5
"""Half the side of the square round a point that stays free."""

Point = tuple[float, float]
Box = tuple[float, float, float, float]
"""Left, bottom, right, top, in the canvas's own pixels."""


def place_labels(
    axes: Axes, named: Sequence[tuple[str, float, float]], steps: Sequence[tuple[float, float]] = ()
) -> None:
    """Write each point's name beside it, inside of the axes, with a thin line to it where it stands far off.

    named: name, x, y. steps: corners of a stepped line (`where="post"`) that names keep off as well.
    A name for which there is no free place takes the one that covers the least. The axes must have been drawn.
    """
    from matplotlib import patheffects

    from tangible_report.style import INK

    per_point = axes.figure.dpi / 72
    left, bottom, right, top = axes.bbox.extents
    points = [_on_canvas(axes, x, y) for _, x, y in named]
    taken: list[Box] = [_around(point, POINT_PT * per_point) for point in points]
    taken += _along([_on_canvas(axes, x, y) for x, y in steps], per_point)
    for (name, x, y), point in sorted(zip(named, points, strict=True), key=lambda pair: -pair[1][1]):
        size = _size(axes, name)
        places = [_shifted(point, offset, size) for offset in _offsets(per_point, size)]
        box = min(places, key=lambda place: _covered(place, taken, (left, bottom, right, top)))
        far = _gap(point, box) > 1.5 * RINGS_PT[0] * per_point
        taken.append(box)
        axes.annotate(
            name,
            (x, y),
            ((box[0] - point[0]) / per_point, (box[1] - point[1]) / per_point),
            textcoords="offset points",
            ha="left",
            va="bottom",
            fontsize=8,
            color=INK,
            zorder=4,
            path_effects=[patheffects.withStroke(linewidth=2, foreground="white")],
            arrowprops={"arrowstyle": "-", "linewidth": 0.4, "color": INK, "shrinkB": 4} if far else None,
        )


def _on_canvas(axes: Axes, x: float, y: float) -> Point:
    across, up = axes.transData.transform((x, y))
    return float(across), float(up)


def _size(axes: Axes, name: str) -> tuple[float, float]:
    text = axes.text(0, 0, name, fontsize=8)
    box = text.get_window_extent()
    text.remove()
    return box.width, box.height


def _offsets(per_point: float, size: tuple[float, float]) -> list[tuple[float, float]]:
    """Where the name's lower left corner may lie, seen from the point: rings about it, the nearest first."""
    angles = 2 * np.pi * np.arange(TURNS) / TURNS
    return [
        (
            ring * per_point * np.cos(angle) + (np.cos(angle) - 1) / 2 * size[0],
            ring * per_point * np.sin(angle) + (np.sin(angle) - 1) / 2 * size[1],
        )
        for ring, angle in product(RINGS_PT, angles)
    ]


def _covered(box: Box, taken: Sequence[Box], frame: Box) -> float:
    """Area that a box shares with taken ones, and that it has outside of the frame."""
    outside = (box[2] - box[0]) * (box[3] - box[1]) - _shared(box, frame)
    return outside + sum(_shared(box, each) for each in taken)


def _shared(one: Box, other: Box) -> float:
    width = min(one[2], other[2]) - max(one[0], other[0])
    height = min(one[3], other[3]) - max(one[1], other[1])
    return max(0.0, width) * max(0.0, height)


def _along(corners: Sequence[Point], half: float) -> list[Box]:
    """Boxes round the level and the upright piece of each step."""
    found: list[Box] = []
    for (left, high), (right, low) in pairwise(corners):
        found += [(left, high - half, right, high + half), (right - half, low, right + half, high)]
    return found


def _gap(point: Point, box: Box) -> float:
    across = max(box[0] - point[0], point[0] - box[2], 0.0)
    return math.hypot(across, max(box[1] - point[1], point[1] - box[3], 0.0))


def _around(point: Point, half: float) -> Box:
    return point[0] - half, point[1] - half, point[0] + half, point[1] + half


def _shifted(point: Point, offset: tuple[float, float], size: tuple[float, float]) -> Box:
    left, bottom = point[0] + offset[0], point[1] + offset[1]
    return left, bottom, left + size[0], bottom + size[1]
