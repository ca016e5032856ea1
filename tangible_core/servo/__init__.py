"""The force loop in its own process: a thousand ticks a second, and no force when anything goes wrong."""

from .beacon import Beacon, BeaconState, beacon_to
from .child import TERMINATED
from .guard.safety import Safety
from .host import Servo
from .packed import Packed, pack_touch
from .ring import Ring
from .still import null_touch
from .supervisor import OVER

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
