"""The panels of the relief: from above, lit from one side as fingers feel it, and as a block."""

from dataclasses import replace
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.collections import PolyCollection
from matplotlib.colors import LightSource, Normalize
from matplotlib.patches import Polygon
from matplotlib.ticker import MaxNLocator

from tangible_core.data import Relief
from tangible_core.scene import normals

from ..block import add_border, drawn_size, facets, on_paper, points_of
from ..style import INK, VIRIDIS, bare, colour_bar, inches

LIGHT = LightSource(azdeg=315, altdeg=50)
LOW_LIGHT = LightSource(azdeg=315, altdeg=35)
"""A light so low that a slope of 45 degrees that looks away from it is dark."""
PIXELS = 700
"""The number of drawn cells along the longer side of the relief from above."""
CELLS = 160
"""The number of cells along the longer side of a block, and for normals."""
NORMALS = 16
"""The number of normals along the longer side."""
ARROW = 0.035
"""The length of the arrow of a horizontal normal, as a share of the longer side."""
FLAT_M = 1e-6
"""The height below which a relief is drawn as a plane."""
ROOM_IN = (0.1, 0.45, 0.4, 0.12)
"""The room left of the block, right of it, below and above, for its scales and normals, inches."""
SCALE_MARK_IN = 0.35
"""The least distance between two numbers of a scale, inches."""
TICK = {"arrowstyle": "-", "linewidth": 0.6, "shrinkA": 0, "shrinkB": 0}


def draw_relief(axes: Axes, relief: Relief) -> str:
    """Draw heights from above, lit low from the upper left, with the horizontal parts of some normals; in mm."""
    shown = drawn_size(relief, PIXELS)
    heights_mm = np.float32(1000) * shown.height_m
    heights = ScalarMappable(Normalize(0, max(float(heights_mm.max()), 1000 * FLAT_M)), VIRIDIS)
    width_m, length_m = shown.pitch_m
    framed = np.pad(shown.height_m, 1, "edge")  # matplotlib shades with the differences of neighbours
    paint = heights.to_rgba(np.pad(heights_mm, 1, "edge"))[..., :3]
    lit = LOW_LIGHT.shade_rgb(paint, framed, blend_mode=_tint, dx=width_m, dy=length_m)[1:-1, 1:-1]
    right_mm, far_mm = (500 * extent for extent in relief.extent_m)
    axes.imshow(np.clip(lit, 0, 1), extent=(-right_mm, right_mm, -far_mm, far_mm))
    axes.autoscale(False)
    bare(axes, f"{2 * right_mm:.3g} x {2 * far_mm:.3g} mm, heights in mm")
    _draw_normals(axes, drawn_size(relief, CELLS))
    colour_bar(axes, heights, "")
    return "Relief and its normals"


def draw_surface(axes: Axes, relief: Relief) -> str:
    """Draw the relief as a block without normals, for a fine texture."""
    relief = drawn_size(relief, CELLS)
    highest_m, stretch = float(relief.height_m.max()), _stretch(relief)
    heights = ScalarMappable(Normalize(0, 1000 * max(highest_m, FLAT_M)), VIRIDIS)
    stretched = replace(relief, height_m=np.float32(stretch) * relief.height_m)
    _draw_block(axes, stretched, heights.to_rgba(np.pad(1000 * relief.height_m, 1, "edge"))[..., :3])
    _leave_room(axes, stretched)
    width_m, length_m = relief.extent_m
    _draw_scale(axes, "x [mm]", np.array([0, -length_m / 2, 0]), np.array([1.0, 0, 0]), width_m / 2)
    _draw_scale(axes, "y [mm]", np.array([width_m / 2, 0, 0]), np.array([0, 1.0, 0]), length_m / 2)
    axes.set_axis_off()
    colour_bar(axes, heights, "height [mm]")
    if highest_m <= FLAT_M:
        return "Surface, smooth"
    return f"Surface, heights x {stretch}" if stretch > 1 else "Surface"


def _leave_room(axes: Axes, stretched: Relief) -> None:
    """Set the limits of the axes: true proportion, with the block centred in the room that the scales leave."""
    x_m, y_m = (side / 2 for side in stretched.extent_m)
    heights_m = 0.0, float(stretched.height_m.max())
    corners = on_paper(np.array([(x, y, z) for x in (-x_m, x_m) for y in (-y_m, y_m) for z in heights_m]))
    least, most = corners.min(axis=0), corners.max(axis=0)
    shares, (left_in, right_in, low_in, high_in) = np.array(inches(axes)), ROOM_IN
    free_in = 1 / shares - [left_in + right_in, low_in + high_in]
    per_in = float(np.max((most - least) / np.maximum(free_in, 0.2)))
    start = (least + most) / 2 - per_in * (free_in / 2 + [left_in, low_in])
    end = start + per_in / shares
    axes.set(xlim=(start[0], end[0]), ylim=(start[1], end[1]), aspect="auto")


def _stretch(relief: Relief) -> int:
    """Return the whole factor on heights that makes the block at least a sixth of its longer side high."""
    top_m = float(relief.height_m.max())
    return max(1, round(max(relief.extent_m) / 6 / top_m)) if top_m > FLAT_M else 1


def _draw_block(axes: Axes, relief: Relief, paint: np.ndarray) -> None:
    points_m = add_border(points_of(relief), relief.extent_m)
    width_m, length_m = relief.pitch_m
    lit = LIGHT.shade_rgb(paint, points_m[..., 2], blend_mode=_dim, dx=width_m, dy=length_m)
    top = facets(points_m)
    corners: Any = top.corners  # matplotlib takes arrays of polygons; its types know only lists of them
    colours = lit[top.row, top.column]
    cells = PolyCollection(corners, facecolors=colours, edgecolors="face", linewidths=0.3, rasterized=True)
    axes.add_collection(cells, autolim=False)  # `_leave_room` sets the limits
    for edge_m, grey in ((points_m[-1], "0.72"), (points_m[:, -1], "0.55")):
        wall_m = np.concatenate([edge_m, edge_m[::-1] * (1, 1, 0)])
        axes.add_patch(Polygon(on_paper(wall_m), facecolor=grey, edgecolor=INK, linewidth=0.4))


def _dim(colours: np.ndarray, light: np.ndarray) -> np.ndarray:
    return colours * (0.3 + 0.7 * light)


def _tint(colours: np.ndarray, light: np.ndarray) -> np.ndarray:
    """Return colours that are paler than the height's, and as light as they are lit."""
    return (0.45 + 0.55 * colours) * (0.15 + 1.05 * light)


def _draw_normals(axes: Axes, relief: Relief) -> None:
    """Draw the horizontal parts of normals as arrows: where it is level, a point."""
    step = max(1, max(relief.height_m.shape) // NORMALS)
    some = np.s_[step // 2 :: step, step // 2 :: step]
    base_mm, normal = 1000 * points_of(relief)[some].reshape(-1, 3), normals(relief)[some].reshape(-1, 3)
    axes.quiver(
        *base_mm[:, :2].T, *normal[:, :2].T, units="inches", width=0.012, minlength=0.6,
        angles="xy", scale_units="xy", scale=1 / (1000 * ARROW * max(relief.extent_m)), color=INK,
    )  # fmt: skip


def _draw_scale(axes: Axes, name: str, middle_m: np.ndarray, along: np.ndarray, half_m: float) -> None:
    """Draw ticks and a name below an edge of the base, at right angles to it; no ticks in the corners."""
    way = on_paper(along)
    below = np.array([way[1], -way[0]]) / np.linalg.norm(way)
    ends = axes.transData.transform([on_paper(middle_m - half_m * along), on_paper(middle_m + half_m * along)])
    long_in = float(np.hypot(*(ends[1] - ends[0]))) / axes.figure.dpi
    for tick_mm in MaxNLocator(min(4, max(1, int(long_in / SCALE_MARK_IN)))).tick_values(-1000 * half_m, 1000 * half_m):
        if abs(tick_mm) < 950 * half_m:
            at = on_paper(middle_m + tick_mm / 1000 * along)
            _write(axes, "", at, 4 * below, arrowprops=TICK)
            _write(axes, f"{tick_mm:g}".replace("-", "\N{MINUS SIGN}"), at, 11 * below, fontsize=8)
    _write(axes, name, on_paper(middle_m), 24 * below, rotation=np.degrees(np.arctan2(way[1], way[0])))


def _write(axes: Axes, text: str, at: np.ndarray, offset_pt: np.ndarray, **look: Any) -> None:
    offset = (offset_pt[0], offset_pt[1])
    axes.annotate(text, (at[0], at[1]), offset, textcoords="offset points", ha="center", va="center", **look)
