"""The panels of the input pictures, of disparity and of its error."""

import numpy as np
from matplotlib.axes import Axes

from tangible_core.data import DisparityMap, Views, to_rgb8
from tangible_core.metrics import absolute_error, disparity_errors

from ..style import ERRORS, VIRIDIS, bare, colour_bar, hatch, thin_out


def draw_views(axes: Axes, views: Views) -> str:
    """Draw the left view, with the right one small in its corner."""
    rows, columns = views.shape
    axes.imshow(to_rgb8(thin_out(views.left)), interpolation="antialiased")
    bare(axes, f"{columns} x {rows} px{_camera(views)}")
    if views.right is None:
        return "Input"
    corner = axes.inset_axes((0.64, 0.015, 0.35, 0.35), anchor="SE")
    corner.imshow(to_rgb8(thin_out(views.right, 400)), interpolation="antialiased")
    corner.set(xticks=[], yticks=[])
    corner.spines[:].set(color="white", linewidth=1.5)
    return "Input: left, inset right"


def _camera(views: Views) -> str:
    at = views.calibration
    if at is None:
        return ""
    baseline = f"{1000 * at.baseline_m:.4g} mm" if at.baseline_m < 1 else f"{at.baseline_m:.4g} m"
    return f", f {at.focal_px:.4g} px, B {baseline}"


CLIP_PX = 4.0  # the error at which colours are clipped, pixels
UNITS = {"px": ("Disparity", "disparity [px]"), "relative": ("Relative nearness", "nearness, 0 far to 1 near")}
"""Unit -> headline and label of the colour bar."""


def draw_disparity(axes: Axes, disparity: DisparityMap) -> str:
    """Draw the map from far (dark) to near (bright); unknown pixels are hatched."""
    values = disparity.disparity_px
    finite = values[np.isfinite(values)]
    low, high = np.percentile(finite, (0.5, 99.5)) if finite.size else (0.0, 1.0)
    hatch(axes)
    image = axes.imshow(np.ma.masked_invalid(thin_out(values)), cmap=VIRIDIS, vmin=low, vmax=high)
    headline, label = UNITS[disparity.unit]
    colour_bar(axes, image, label, extend="both")
    missing = 100 * (1 - finite.size / values.size)
    bare(axes, f"hatched: unknown, {missing:.1f} %" if missing else "known everywhere")
    return headline


def draw_disparity_error(axes: Axes, disparity: DisparityMap, truth: np.ndarray) -> str:
    """Draw the absolute error, clipped at CLIP_PX; pixels without estimate are hatched, pixels without truth white."""
    figures = disparity_errors(disparity.disparity_px, truth)
    error_px = thin_out(absolute_error(disparity.disparity_px, truth))
    hatch(axes)
    axes.imshow(np.ma.masked_where(np.isfinite(thin_out(truth)), np.ones(error_px.shape)), cmap="gray", vmin=0, vmax=1)
    image = axes.imshow(np.ma.masked_invalid(error_px), cmap=ERRORS, vmin=0, vmax=CLIP_PX)
    colour_bar(axes, image, f"|error| [px], clipped at {CLIP_PX:g}", extend="max", ticks=range(int(CLIP_PX) + 1))
    bare(axes, "hatched: no estimate (bad); white: no truth")
    return f"Error: bad1 {figures['bad1']:.1f} %, bad2 {figures['bad2']:.1f} %"
