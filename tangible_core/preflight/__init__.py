"""What can be known before a motor moves: of the surface, the law, the device and this machine; a verdict a line."""

from .checks import CHECKS, judge
from .flight import Flight, Hand, Loop
from .survey import survey
from .timing import PERCENTILES
from .verdict import Verdict

__all__ = ["CHECKS", "PERCENTILES", "Flight", "Hand", "Loop", "Verdict", "judge", "survey"]
