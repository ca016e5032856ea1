"""Labels for the points of a plot, placed so that none covers another label or a point."""
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
"""The distances from a point at which a label is tried, the nearest first, points (1/72 inch)."""
TURNS = 16
"""The number of directions that are tried at each distance."""
POINT_PT = 5
"""Half the side of the free square around a point, points."""

Point = tuple[float, float]
Box = tuple[float, float, float, float]
"""A rectangle: left, bottom, right, top, pixels of the canvas."""


def place_labels(
    axes: Axes, named: Sequence[tuple[str, float, float]], steps: Sequence[tuple[float, float]] = ()
) -> None:
    """Write each point's name next to the point, inside the axes, with a thin line between them if they are far apart.

    named: name, x, y. steps: corners of a stepped line (`where="post"`) that labels avoid as well.
    A label without a free place takes the place that covers the least. The axes must have been drawn before.
    """
    from matplotlib import patheffects

    from tangible_report.style import INK

    per_point = axes.figure.dpi / 72
    left, bottom, right, top = axes.bbox.extents
    points = [_on_canvas(axes, x, y) for _, x, y in named]
    taken: list[Box] = [_square(point, POINT_PT * per_point) for point in points]
    taken += _step_boxes([_on_canvas(axes, x, y) for x, y in steps], per_point)
    for (name, x, y), point in sorted(zip(named, points, strict=True), key=lambda pair: -pair[1][1]):
        size = _size(axes, name)
        places = [_box_at(point, offset, size) for offset in _offsets(per_point, size)]
        box = min(places, key=lambda place: _overlap(place, taken, (left, bottom, right, top)))
        far = _distance(point, box) > 1.5 * RINGS_PT[0] * per_point
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
    """Return the offsets from a point to the lower left corner of its label, in rings, the nearest first."""
    angles = 2 * np.pi * np.arange(TURNS) / TURNS
    return [
        (
            ring * per_point * np.cos(angle) + (np.cos(angle) - 1) / 2 * size[0],
            ring * per_point * np.sin(angle) + (np.sin(angle) - 1) / 2 * size[1],
        )
        for ring, angle in product(RINGS_PT, angles)
    ]


def _overlap(box: Box, taken: Sequence[Box], frame: Box) -> float:
    """Return the area of a box that other boxes cover, plus the area outside of the frame."""
    outside = (box[2] - box[0]) * (box[3] - box[1]) - _intersection(box, frame)
    return outside + sum(_intersection(box, each) for each in taken)


def _intersection(one: Box, other: Box) -> float:
    width = min(one[2], other[2]) - max(one[0], other[0])
    height = min(one[3], other[3]) - max(one[1], other[1])
    return max(0.0, width) * max(0.0, height)


def _step_boxes(corners: Sequence[Point], half: float) -> list[Box]:
    """Return boxes around the level and the upright piece of each step."""
    boxes: list[Box] = []
    for (left, high), (right, low) in pairwise(corners):
        boxes += [(left, high - half, right, high + half), (right - half, low, right + half, high)]
    return boxes


def _distance(point: Point, box: Box) -> float:
    across = max(box[0] - point[0], point[0] - box[2], 0.0)
    return math.hypot(across, max(box[1] - point[1], point[1] - box[3], 0.0))


def _square(point: Point, half: float) -> Box:
    return point[0] - half, point[1] - half, point[0] + half, point[1] + half


def _box_at(point: Point, offset: tuple[float, float], size: tuple[float, float]) -> Box:
    left, bottom = point[0] + offset[0], point[1] + offset[1]
    return left, bottom, left + size[0], bottom + size[1]
