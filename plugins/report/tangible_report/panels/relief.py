"""The panels of the relief, from above and as a block, and of forces: arrows on the map, force and tip over time."""

from typing import Any

import numpy as np
from jaxtyping import Bool, Float32, Float64, Int64
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import LightSource, Normalize

from tangible_core.data import Relief
from tangible_core.scene import normals, picture_to_workspace, resample, workspace_to_picture
from tangible_core.session import Recording

from ..style import FORCES, INK, OKABE_ITO, VIRIDIS, bare, colour_bar, inches

ARROWS = 150  # the most arrows
# The length of the arrow of a strong lateral force, as a share of the surface's size (the mean of its sides).
STRONG = 0.1
LIGHT = LightSource(azdeg=315, altdeg=50)
# A light so low that a slope of 45 degrees that looks away from it is dark.
LOW_LIGHT = LightSource(azdeg=315, altdeg=35)
PIXELS = 700  # the number of drawn cells along the longer side of the relief from above
CELLS = 160  # the number of cells along the longer side of a block, and for normals
NORMALS = 16  # the number of normals along the longer side
# The length of the arrow of a horizontal normal, as a share of the longer side.
ARROW = 0.035
FLAT_M = 1e-6  # the height below which a relief is drawn as a plane


def draw_force_map(axes: Axes, relief: Relief, recording: Recording) -> str:
    """Draw lateral forces as arrows (their scale is below) and vertical forces as their colour, over shaded heights."""
    _draw_heights(axes, relief)
    at_mm = 1000 * recording.position_m
    axes.plot(at_mm[:, 0], at_mm[:, 1], color=INK, linewidth=0.5, alpha=0.6)
    some = spread(at_mm, np.linalg.norm(recording.force_n, axis=1) > 0, ARROWS)
    if not some.size:
        return "Path, never in contact"
    _draw_arrows(axes, at_mm[some], recording.force_n[some], (1000 * relief.extent_m[0], 1000 * relief.extent_m[1]))
    return "Lateral force along the path"


def _draw_heights(axes: Axes, relief: Relief) -> None:
    small = drawn_size(relief, 600)
    width_m, length_m = small.pitch_m
    light = LightSource(azdeg=315, altdeg=50).hillshade(np.pad(small.height_m, 1, "edge"), dx=width_m, dy=length_m)
    right_mm, far_mm = (500 * extent for extent in relief.extent_m)
    axes.imshow(light[1:-1, 1:-1], cmap="gray", vmin=-2, vmax=1, extent=(-right_mm, right_mm, -far_mm, far_mm))
    axes.autoscale(False)
    axes.set_xlabel("x [mm]", loc="left")
    axes.set_ylabel("y [mm]")


def _draw_arrows(
    axes: Axes, at_mm: Float64[np.ndarray, "n 3"], force_n: Float64[np.ndarray, "n 3"], size_mm: tuple[float, float]
) -> None:
    """Draw lateral arrows, cut to twice the arrow of the scale below the map."""
    width_mm, strong_mm = size_mm[0], STRONG * (size_mm[0] * size_mm[1]) ** 0.5
    lateral_n = np.hypot(force_n[:, 0], force_n[:, 1])
    key_n = round_number(float(np.percentile(lateral_n, 95)))
    cut = np.minimum(1, 2 * key_n / np.maximum(lateral_n, 1e-300))
    arrows = axes.quiver(
        *at_mm[:, :2].T, *(force_n[:, :2] * cut[:, None]).T, force_n[:, 2],
        cmap=FORCES, angles="xy", scale_units="xy", scale=key_n / strong_mm, units="inches", width=0.014,
    )  # fmt: skip
    wide, high = inches(axes)
    label = f"{key_n:g} N" + (f", cut at {2 * key_n:g} N" if cut.min() < 1 else "")
    right = 1 + 0.8 * wide - strong_mm / width_mm
    axes.quiverkey(arrows, right, -0.47 * high, key_n, label, labelpos="W", coordinates="axes", color=INK)
    colour_bar(axes, arrows, "vertical force [N]")


def spread(at_mm: Float64[np.ndarray, "n 3"], touching: Bool[np.ndarray, " n"], most: int) -> Int64[np.ndarray, " m"]:
    """Return the indices of at most `most` samples in contact, at equal steps of the path, or of time at rest."""
    some = np.flatnonzero(touching)
    if not some.size:
        return some
    step_mm = np.linalg.norm(np.diff(at_mm, axis=0, prepend=at_mm[:1]), axis=1)
    way_mm = np.cumsum(step_mm * touching)[some]
    if way_mm[0] == way_mm[-1]:
        way_mm = np.arange(some.size, dtype=np.float64)
    marks_mm = np.linspace(float(way_mm[0]), float(way_mm[-1]), most)
    return some[np.unique(np.searchsorted(way_mm, marks_mm))]


def round_number(value: float) -> float:
    """Return the largest of ..., 0.1, 0.2, 0.5, 1, 2, 5, ... up to the value; 1 if the value is not positive.

    >>> round_number(0.73), round_number(30.0)
    (0.5, 20.0)
    """
    if value <= 0:
        return 1.0
    decade = 10.0 ** np.floor(np.log10(value))
    return float(max(factor * decade for factor in (1, 2, 5) if factor * decade <= value * (1 + 1e-9)))


TIP, CONTACT, FORCE = OKABE_ITO[0], OKABE_ITO[1], OKABE_ITO[5]
GROUND = "#c4c4c4"
# The number of intervals in which contact is shaded, more than a sheet has dots.
INSTANTS = 2000


def draw_force_time(axes: Axes, recording: Recording, relief: Relief | None = None) -> str:
    """Draw the force's magnitude over time and, below it, the tip, over the surface if it is known; shade contact."""
    axes.set_axis_off()
    upper, lower = axes.inset_axes((0, 0.54, 1, 0.46)), axes.inset_axes((0, 0, 1, 0.46))
    lower.sharex(upper)
    force_n = np.linalg.norm(recording.force_n, axis=1)
    for part in (upper, lower):
        _shade(part, recording.time_s, force_n > 0)
        part.margins(x=0)
    upper.plot(recording.time_s, force_n, color=FORCE, linewidth=0.9, label="force")
    upper.set(ylabel="force [N]", ylim=(0, None))
    upper.tick_params(labelbottom=False)
    _draw_tip(lower, relief, recording)
    _draw_legend(upper, lower)
    contact = 100 * np.count_nonzero(force_n) / force_n.size
    return f"Force and tip over time: peak {force_n.max():.2f} N, contact {contact:.0f} %"


def _draw_tip(axes: Axes, relief: Relief | None, recording: Recording) -> None:
    if relief is not None:
        ground_mm = 1000 * heights_under(relief, recording.position_m)
        axes.fill_between(recording.time_s, ground_mm, color=GROUND, linewidth=0, zorder=0.5, label="surface")
    tip_mm = 1000 * recording.position_m[:, 2]
    axes.plot(recording.time_s, tip_mm, color=TIP, linewidth=0.9, label="tip")
    axes.set(xlabel="time [s]", ylabel="height [mm]", ylim=(min(0.0, float(tip_mm.min())), None))


def _shade(axes: Axes, time_s: Float64[np.ndarray, " n"], touching: Bool[np.ndarray, " n"]) -> None:
    """Shade the time in contact; an interval counts if it has any contact."""
    starts = np.linspace(0, time_s.size, min(time_s.size, INSTANTS), endpoint=False).astype(int)
    some = np.maximum.reduceat(touching, starts)
    axes.fill_between(
        time_s[starts], 0, 1, where=some, step="post", transform=axes.get_xaxis_transform(),
        color=CONTACT, alpha=0.15, linewidth=0, zorder=0.2, label="contact",
    )  # fmt: skip


def _draw_legend(upper: Axes, lower: Axes) -> None:
    """Draw one legend for both axes, right of the headline."""
    keys = {label: key for part in (upper, lower) for key, label in zip(*part.get_legend_handles_labels(), strict=True)}
    upper.legend(
        keys.values(), keys.keys(), ncols=len(keys), loc="lower right", bbox_to_anchor=(1.0, 0.97), borderaxespad=0.2
    )


def heights_under(relief: Relief, points_m: Float64[np.ndarray, "... 3"]) -> Float32[np.ndarray, "..."]:
    """Return the height of the cell below (or above) each point, metres; NaN outside the surface."""
    shape = rows, columns = relief.height_m.shape
    places = workspace_to_picture(points_m[..., 0], points_m[..., 1], shape, relief.extent_m)
    column, row = (np.floor(place + 0.5) for place in places)
    inside = (column >= 0) & (column < columns) & (row >= 0) & (row < rows)
    height_m = relief.height_m[np.where(inside, row, 0).astype(int), np.where(inside, column, 0).astype(int)]
    return np.where(inside, height_m, np.nan)


def drawn_size(relief: Relief, most: int) -> Relief:
    """Resample the surface to at most `most` cells a side."""
    rows, columns = relief.height_m.shape
    scale = min(1.0, most / max(rows, columns))
    return resample(relief, (max(1, round(rows * scale)), max(1, round(columns * scale))))


def cell_points(relief: Relief) -> Float64[np.ndarray, "h w 3"]:
    """Return the cell centres at their heights, in the workspace frame."""
    row, column = np.indices(relief.height_m.shape, np.float64)
    x_m, y_m = picture_to_workspace(column, row, relief.height_m.shape, relief.extent_m)
    return np.stack([x_m, y_m, relief.height_m], axis=-1)


def draw_relief(axes: Axes, relief: Relief) -> str:
    """Draw heights from above, lit low from the upper left, with the horizontal parts of some normals; in mm."""
    small = drawn_size(relief, PIXELS)
    heights_mm = np.float32(1000) * small.height_m
    heights = ScalarMappable(Normalize(0, max(float(heights_mm.max()), 1000 * FLAT_M)), VIRIDIS)
    width_m, length_m = small.pitch_m
    with_frame = np.pad(small.height_m, 1, "edge")  # matplotlib shades with the differences of neighbours
    paint = heights.to_rgba(np.pad(heights_mm, 1, "edge"))[..., :3]
    lit = LOW_LIGHT.shade_rgb(paint, with_frame, blend_mode=_tint, dx=width_m, dy=length_m)[1:-1, 1:-1]
    right_mm, far_mm = (500 * extent for extent in relief.extent_m)
    axes.imshow(np.clip(lit, 0, 1), extent=(-right_mm, right_mm, -far_mm, far_mm))
    axes.autoscale(False)
    bare(axes, f"{2 * right_mm:.3g} x {2 * far_mm:.3g} mm, heights in mm")
    _draw_normals(axes, drawn_size(relief, CELLS))
    colour_bar(axes, heights, "")
    return "Relief and its normals"


def draw_surface(axes: Axes, relief: Relief) -> str:
    """Draw the relief as a block without normals, for a fine texture; low heights are multiplied until they show."""
    small = drawn_size(relief, CELLS)
    highest_m, (width_m, length_m) = float(small.height_m.max()), small.extent_m
    stretch = max(1, round(max(width_m, length_m) / 6 / highest_m)) if highest_m > FLAT_M else 1
    heights = ScalarMappable(Normalize(0, 1000 * max(highest_m, FLAT_M)), VIRIDIS)
    x_mm, y_mm, z_mm = 1000 * np.moveaxis(cell_points(small), -1, 0)
    pitch_mm = {"dx": 1000 * small.pitch_m[0], "dy": 1000 * small.pitch_m[1]}
    lit = LIGHT.shade_rgb(heights.to_rgba(z_mm)[..., :3], stretch * z_mm, blend_mode=_dim, **pitch_mm)
    axes.set_axis_off()
    block: Any = axes.inset_axes((0, 0, 1, 1), projection="3d")
    block.plot_surface(x_mm, y_mm, z_mm, rcount=CELLS, ccount=CELLS, facecolors=lit, shade=False, rasterized=True)
    block.set(xlabel="x [mm]", ylabel="y [mm]", zticks=[], zlim=(0, 1000 * max(highest_m, FLAT_M)), proj_type="ortho")
    block.set_box_aspect((width_m, length_m, stretch * max(highest_m, FLAT_M)), zoom=1.15)
    block.view_init(elev=42, azim=-68)  # from the user's side and a little from the right
    colour_bar(axes, heights, "height [mm]")
    if highest_m <= FLAT_M:
        return "Surface, smooth"
    return f"Surface, heights x {stretch}" if stretch > 1 else "Surface"


def _dim(colours: np.ndarray, light: np.ndarray) -> np.ndarray:
    return colours * (0.3 + 0.7 * light)


def _tint(colours: np.ndarray, light: np.ndarray) -> np.ndarray:
    """Return colours that are paler than the height's, and as light as they are lit."""
    return (0.45 + 0.55 * colours) * (0.15 + 1.05 * light)


def _draw_normals(axes: Axes, relief: Relief) -> None:
    """Draw the horizontal parts of normals as arrows: where it is level, a point."""
    step = max(1, max(relief.height_m.shape) // NORMALS)
    some = np.s_[step // 2 :: step, step // 2 :: step]
    base_mm, normal = 1000 * cell_points(relief)[some].reshape(-1, 3), normals(relief)[some].reshape(-1, 3)
    axes.quiver(
        *base_mm[:, :2].T, *normal[:, :2].T, units="inches", width=0.012, minlength=0.6,
        angles="xy", scale_units="xy", scale=1 / (1000 * ARROW * max(relief.extent_m)), color=INK,
    )  # fmt: skip
