"""The force loop in its own process: a thousand ticks a second, and no force when anything goes wrong."""

from .beacon import Beacon as Beacon
from .beacon import BeaconState as BeaconState
from .beacon import beacon_to as beacon_to
from .guard.safety import Safety as Safety
from .host import Servo as Servo
from .packed_touch import Packed as Packed
from .packed_touch import pack_touch as pack_touch
from .ring import Ring as Ring
from .supervisor import OVER as OVER
from .ticks.null_law import null_touch as null_touch
