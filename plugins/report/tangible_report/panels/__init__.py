"""The panels of the sheet: a function each, which draws into its axes and returns its headline."""

from tangible_core.plugins import Panel as Panel

from .pictures import draw_disparity, draw_disparity_error, draw_parts, draw_segments, draw_views
from .relief import draw_force_map, draw_force_time, draw_relief

PANELS = (
    Panel(draw_views, {"views"}, least_in=2.2),
    Panel(draw_disparity, {"disparity"}, right_in=0.85, least_in=2.2),
    Panel(draw_disparity_error, {"disparity", "truth"}, right_in=0.75),
    Panel(draw_segments, {"segments"}, {"views", "materials"}, right_in=1.75),
    Panel(draw_parts, {"parts"}, {"views", "surface"}, right_in=1.75),
    Panel(draw_relief, {"relief"}, right_in=0.45),
    Panel(draw_force_map, {"relief", "recording"}, left_in=0.65, right_in=0.95, bottom_in=0.65),
    Panel(draw_force_time, {"recording"}, {"relief"}, 4.5, left_in=0.65, bottom_in=0.55, least_in=7.6),
)
"""The panels in the order in which a picture becomes a force."""
