"""The relief as a lit block, with some of its normals."""
# pyright: reportUnknownMemberType=false
# (matplotlib leaves its keywords without types)

from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.collections import PolyCollection
from matplotlib.colors import LightSource, Normalize
from matplotlib.patches import Polygon
from matplotlib.ticker import MaxNLocator

from ...data import Relief
from ...scene.geometry import normals
from ..block import drawn_size, facets, framed, on_paper, points_of, seen
from ..style import INK, VIRIDIS, colour_bar

LIGHT = LightSource(azdeg=315, altdeg=50)
CELLS = 160
"""Along the longer side."""
NORMALS = 11
"""Along the longer side."""
FLAT_M = 1e-6
"""Lower reliefs are drawn as a plane."""
TICK = {"arrowstyle": "-", "linewidth": 0.6, "shrinkA": 0, "shrinkB": 0}


def draw_relief(axes: Axes, relief: Relief) -> str:
    """Heights lit from the upper left, in true proportion or stretched as the headline says; axes in mm."""
    stretched = _draw_heights(axes, drawn_size(relief, CELLS))
    _draw_normals(axes, stretched.relief)
    return f"Relief and its normals{stretched.note}"


def draw_surface(axes: Axes, relief: Relief) -> str:
    """The same without normals, for a fine texture."""
    drawn = _draw_heights(axes, drawn_size(relief, CELLS))
    return f"Surface{drawn.note if relief.height_m.max() > FLAT_M else ', smooth'}"


class _StretchedRelief(NamedTuple):
    """A relief as it is drawn, and what to say of its proportion."""

    relief: Relief
    note: str


def _draw_heights(axes: Axes, relief: Relief) -> _StretchedRelief:
    stretch = _stretch(relief)
    heights = ScalarMappable(Normalize(0, 1000 * max(float(relief.height_m.max()), FLAT_M)), VIRIDIS)
    stretched = replace(relief, height_m=np.float32(stretch) * relief.height_m)
    _draw_block(axes, stretched, heights.to_rgba(np.pad(1000 * relief.height_m, 1, "edge"))[..., :3])
    _draw_scales(axes, *relief.extent_m)
    axes.margins(0.07)
    axes.set_aspect("equal", adjustable="datalim")
    axes.set_axis_off()
    colour_bar(axes, heights, "height [mm]")
    return _StretchedRelief(stretched, f", heights x {stretch}" if stretch > 1 else "")


def _stretch(relief: Relief) -> int:
    """Whole factor on heights that makes the block no flatter than a sixth of its longer side."""
    top_m = float(relief.height_m.max())
    return max(1, round(max(relief.extent_m) / 6 / top_m)) if top_m > FLAT_M else 1


def _draw_block(axes: Axes, relief: Relief, paint: np.ndarray) -> None:
    points_m = framed(points_of(relief), relief.extent_m)
    width_m, length_m = relief.pitch_m
    lit = LIGHT.shade_rgb(paint, points_m[..., 2], blend_mode=_dimmed, dx=width_m, dy=length_m)
    top = facets(points_m)
    corners: Any = top.corners  # matplotlib takes arrays of polygons; its types know only lists of them
    colours = lit[top.row, top.column]
    axes.add_collection(PolyCollection(corners, facecolors=colours, edgecolors="face", linewidths=0.3))
    for edge_m, grey in ((points_m[-1], "0.72"), (points_m[:, -1], "0.55")):
        wall_m = np.concatenate([edge_m, edge_m[::-1] * (1, 1, 0)])
        axes.add_patch(Polygon(on_paper(wall_m), facecolor=grey, edgecolor=INK, linewidth=0.4))


def _dimmed(colours: np.ndarray, light: np.ndarray) -> np.ndarray:
    return colours * (0.3 + 0.7 * light)


def _draw_normals(axes: Axes, relief: Relief) -> None:
    """Normals of the surface as drawn, at the points that the reader sees."""
    step = max(1, max(relief.height_m.shape) // NORMALS)
    some = np.s_[step // 2 :: step, step // 2 :: step]
    base_m, normal = points_of(relief)[some].reshape(-1, 3), normals(relief)[some].reshape(-1, 3)
    clear = seen(relief, base_m)
    arrow_m = 0.08 * max(relief.extent_m) * normal[clear]
    axes.quiver(
        *on_paper(base_m[clear]).T, *on_paper(arrow_m).T,
        angles="xy", scale_units="xy", scale=1, width=0.0035, color=INK,
    )  # fmt: skip


def _draw_scales(axes: Axes, width_m: float, length_m: float) -> None:
    """Scales in mm along the near and the right edge of the base."""
    _draw_scale(axes, "x [mm]", np.array([0, -length_m / 2, 0]), np.array([1.0, 0, 0]), width_m / 2)
    _draw_scale(axes, "y [mm]", np.array([width_m / 2, 0, 0]), np.array([0, 1.0, 0]), length_m / 2)


def _draw_scale(axes: Axes, name: str, middle_m: np.ndarray, along: np.ndarray, half_m: float) -> None:
    """Ticks and a name below an edge of the base, at right angles to it; none in the corners, where scales meet."""
    way = on_paper(along)
    below = np.array([way[1], -way[0]]) / np.linalg.norm(way)
    for tick_mm in MaxNLocator(4).tick_values(-1000 * half_m, 1000 * half_m):
        if abs(tick_mm) < 950 * half_m:
            at = on_paper(middle_m + tick_mm / 1000 * along)
            _write(axes, "", at, 4 * below, arrowprops=TICK)
            _write(axes, f"{tick_mm:g}".replace("-", "\N{MINUS SIGN}"), at, 11 * below, fontsize=8)
    _write(axes, name, on_paper(middle_m), 24 * below, rotation=np.degrees(np.arctan2(way[1], way[0])))


def _write(axes: Axes, text: str, at: np.ndarray, offset_pt: np.ndarray, **look: Any) -> None:
    beside = (offset_pt[0], offset_pt[1])
    axes.annotate(text, (at[0], at[1]), beside, textcoords="offset points", ha="center", va="center", **look)
