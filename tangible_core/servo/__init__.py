"""The force loop in its own process: a thousand ticks a second, and no force when anything goes wrong."""

from .child import TERMINATED
from .guard.safety import Safety
from .host import OVER, Servo
from .ring import Ring

__all__ = ["OVER", "TERMINATED", "Ring", "Safety", "Servo"]
