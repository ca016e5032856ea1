"""The panel of the input pictures."""

from matplotlib.axes import Axes

from tangible_core.data import Views, to_rgb8

from ..style import bare, thin_out


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
