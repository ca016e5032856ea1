"""Every panel of the sheet: one function each, which draws into its axes and returns its headline."""

from collections.abc import Callable, Collection
from typing import NamedTuple

from .disparity import draw_disparity, draw_disparity_error
from .force import draw_force_map
from .relief import draw_relief
from .segments import draw_segments
from .time import draw_force_time
from .views import draw_views


class Panel(NamedTuple):
    """How a panel is drawn, what of a run it shows, and the room that it takes."""

    draw: Callable[..., str]
    needs: Collection[str]
    """Without all of these it is left out."""
    likes: Collection[str] = ()
    """Given to it where the run has them."""
    aspect: float = 0.0
    """Width over height; 0 is the scene's own."""
    left_in: float = 0.15
    right_in: float = 0.15
    bottom_in: float = 0.4


PANELS = (
    Panel(draw_views, {"views"}),
    Panel(draw_disparity, {"disparity"}, right_in=0.85),
    Panel(draw_disparity_error, {"disparity", "truth"}, right_in=0.75),
    Panel(draw_segments, {"segments"}, {"views", "materials"}, right_in=1.4),
    Panel(draw_relief, {"relief"}, aspect=1.45, right_in=0.85),
    Panel(draw_force_map, {"relief", "recording"}, left_in=0.65, right_in=0.85, bottom_in=0.55),
    Panel(draw_force_time, {"recording"}, {"relief"}, aspect=4.5, left_in=0.65, bottom_in=0.55),
)
"""In the order in which a picture becomes a force."""
