"""The panels of the relief: from above, lit from one side as fingers feel it, and as a block."""

from typing import Any

import numpy as np
from jaxtyping import Float64
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import LightSource, Normalize

from tangible_core.data import Relief
from tangible_core.scene import normals, picture_to_workspace, resample

from ..style import INK, VIRIDIS, bare, colour_bar

LIGHT = LightSource(azdeg=315, altdeg=50)
# A light so low that a slope of 45 degrees that looks away from it is dark.
LOW_LIGHT = LightSource(azdeg=315, altdeg=35)
PIXELS = 700  # the number of drawn cells along the longer side of the relief from above
CELLS = 160  # the number of cells along the longer side of a block, and for normals
NORMALS = 16  # the number of normals along the longer side
# The length of the arrow of a horizontal normal, as a share of the longer side.
ARROW = 0.035
FLAT_M = 1e-6  # the height below which a relief is drawn as a plane


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
