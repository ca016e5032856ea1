"""Labels for the points of a plot, placed so that none covers another label or a point."""
# matplotlib keywords have no types.

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Float64

if TYPE_CHECKING:
    from matplotlib.axes import Axes

RINGS_PT = (8, 18, 30, 44, 60, 80)
"""The distances from a point at which a label is tried, the nearest first, points (1/72 inch)."""
TURNS = 16
"""The number of directions that are tried at each distance."""
POINT_PT = 5
"""Half the side of the free square around a point, points."""

Boxes = Float64[np.ndarray, "n 4"]
"""Rectangles: left, bottom, right, top, pixels of the canvas."""


def place_labels(
    axes: Axes, named: Sequence[tuple[str, float, float]], steps: Sequence[tuple[float, float]] = ()
) -> None:
    """Write each point's name next to the point, inside the axes, with a thin line between them if they are far apart.

    named: name, x, y. steps: corners of a stepped line (`where="post"`) that labels avoid as well.
    A label without a free place takes the place that covers the least. The axes must have been drawn before.
    """
    from matplotlib import patheffects
    from matplotlib.text import Text

    from tangible_report.style import INK

    per_point = axes.figure.dpi / 72
    points = axes.transData.transform([each[1:] for each in named])
    corners = axes.transData.transform(list(steps)) if steps else np.empty((0, 2))
    level = np.column_stack([corners[:-1], corners[1:, 0], corners[:-1, 1]])
    upright = np.column_stack([corners[1:, 0], corners[1:, 1], corners[1:, 0], corners[:-1, 1]])
    around = np.array([-1, -1, 1, 1]) * per_point
    taken = np.vstack([np.tile(points, 2) + POINT_PT * around, level + around, upright + around])
    angles = np.tile(2 * np.pi * np.arange(TURNS) / TURNS, len(RINGS_PT))
    turns = np.column_stack([np.cos(angles), np.sin(angles)])
    away = turns * per_point * np.repeat(RINGS_PT, TURNS)[:, None]
    for index in np.argsort(-points[:, 1], kind="stable").tolist():
        (name, x, y), point = named[index], points[index]
        label = axes.annotate(
            name, (x, y), (0, 0), textcoords="offset points", ha="left", va="bottom", fontsize=8, color=INK, zorder=4,
            path_effects=[patheffects.withStroke(linewidth=2, foreground="white")],
            arrowprops={"arrowstyle": "-", "linewidth": 0.4, "color": INK, "shrinkB": 4},
        )  # fmt: skip
        size = np.array(Text.get_window_extent(label).size)
        starts = point + away + (turns - 1) / 2 * size
        places = np.column_stack([starts, starts + size])
        covered = _common_area(places, taken).sum(axis=1) - _common_area(places, np.array([axes.bbox.extents]))[:, 0]
        box = places[int(covered.argmin())]
        taken = np.vstack([taken, box])
        label.set_position((box[:2] - point) / per_point)
        gap = np.maximum(np.maximum(box[:2] - point, point - box[2:]), 0)
        assert label.arrow_patch is not None
        label.arrow_patch.set_visible(np.hypot(*gap) > 1.5 * RINGS_PT[0] * per_point)


def _common_area(some: Boxes, others: Boxes) -> Float64[np.ndarray, "n m"]:
    """Return the area that each of some boxes has in common with each of others."""
    low, high = np.maximum(some[:, None, :2], others[:, :2]), np.minimum(some[:, None, 2:], others[:, 2:])
    return np.maximum(high - low, 0).prod(axis=2)
