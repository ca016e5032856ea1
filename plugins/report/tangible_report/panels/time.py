"""The panel of force and tip over time."""

import numpy as np
from jaxtyping import Bool, Float32, Float64
from matplotlib.axes import Axes

from tangible_core.data import Relief
from tangible_core.scene import workspace_to_picture
from tangible_core.session import Recording

from ..style import OKABE_ITO

TIP, CONTACT, FORCE = OKABE_ITO[0], OKABE_ITO[1], OKABE_ITO[5]
GROUND = "#c4c4c4"
INSTANTS = 2000
"""The number of intervals in which contact is shaded, more than a sheet has dots."""


def draw_force_time(axes: Axes, recording: Recording, relief: Relief | None = None) -> str:
    """Draw the force's magnitude over time and, below it, the tip, over the surface if it is known; shade contact."""
    axes.set_axis_off()
    upper, lower = axes.inset_axes((0, 0.54, 1, 0.46)), axes.inset_axes((0, 0, 1, 0.46))
    lower.sharex(upper)
    force_n = np.linalg.norm(recording.force_n, axis=1)
    for each in (upper, lower):
        _shade(each, recording.time_s, force_n > 0)
        each.margins(x=0)
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
    keys = {label: key for each in (upper, lower) for key, label in zip(*each.get_legend_handles_labels(), strict=True)}
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
