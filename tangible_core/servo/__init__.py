"""The force loop in its own process: a thousand ticks a second, and no force when anything goes wrong."""

from .child import TERMINATED
from .guard.safety import Safety
from .host import OVER, Servo
from .packed import Packed, packed
from .ring import Ring
from .still import still

__all__ = ["OVER", "TERMINATED", "Packed", "Ring", "Safety", "Servo", "packed", "still"]
