"""Moving pictures: disparity that is steady in time, reliefs of one scale, and who shows them to a loop."""

from .player import ByClock, Player
from .reliefs import FrameMaker, FrameRelief, Reliefs
from .steady import Steadied, Steady

__all__ = ["ByClock", "FrameMaker", "FrameRelief", "Player", "Reliefs", "Steadied", "Steady"]
