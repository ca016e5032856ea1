"""The force loop in its own process: a thousand ticks a second, and no force when anything goes wrong."""

from .beacon import Beacon, BeaconState, beacon_to
from .child import TERMINATED
from .guard.safety import Safety
from .host import Servo
from .packed_touch import Packed, pack_touch
from .ring import Ring
from .supervisor import OVER
from .ticks.null_law import null_touch

packed, still = pack_touch, null_touch
"""Former names of these two functions."""

__all__ = [
    "OVER",
    "TERMINATED",
    "Beacon",
    "BeaconState",
    "Packed",
    "Ring",
    "Safety",
    "Servo",
    "beacon_to",
    "null_touch",
    "pack_touch",
]
