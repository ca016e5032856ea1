"""Moving pictures: disparity filtered in time, reliefs of one scale, and players that show them to a force loop."""

from .player import ByClock, Player
from .reliefs import FilteredMap, FrameMaker, FrameRelief, Reliefs, Steady

__all__ = ["ByClock", "FilteredMap", "FrameMaker", "FrameRelief", "Player", "Reliefs", "Steady"]
