"""A panel of a run's sheet."""

from collections.abc import Callable, Collection
from typing import NamedTuple


class Panel(NamedTuple):
    """How a panel is drawn, what of a run it shows, and the room that it takes."""

    draw: Callable[..., str]
    """Called with matplotlib's axes and, by name, what it needs and likes; draws into them and returns a headline."""
    needs: Collection[str]
    """Of views, truth, disparity, segments, parts, materials, relief, surface, recording; without all of these it is
    left out."""
    likes: Collection[str] = ()
    """Given to it where the run has them."""
    aspect: float | Callable[..., float] = 0.0
    """Width over height; 0 is the scene's own. A function is called with what the panel needs and likes, by name."""
    left_in: float = 0.15
    right_in: float = 0.15
    bottom_in: float = 0.4
    least_in: float = 2.9
    """Room for its headline, where its axes are narrower."""
    least_aspect: float = 0.0
    """Width over height beside panels that want to be high, if that is not fixed."""
