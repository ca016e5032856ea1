"""A Force Dimension device in use, through `forcedimension_core.dhd`, the bindings to the maker's library."""

import io
import math
import time
from contextlib import redirect_stderr
from importlib import import_module
from threading import Lock
from typing import Any, final

from tangible_core.data import NO_FORCE, Force, HapticState
from tangible_core.errors import DeviceAbsent, DeviceError
from tangible_core.plugins import Link

INSTALL = (
    "install the Force Dimension SDK 3.16 or newer (forcedimension.com), then pip install "
    "forcedimension-core with Python 3.12 or older; FDSDK in the environment may name the SDK's folder"
)
REPLUG = "check its plug and its power, then open it again"
OPENED: set[int] = set()
"""The devices that this program has open; the library itself would open the same one twice."""
_taking = Lock()


def library() -> Any:
    """Return the bindings. Raises: DeviceAbsent that names what to install."""
    try:
        with redirect_stderr(io.StringIO()):  # its output is less specific than the message below
            return import_module("forcedimension_core.dhd")
    except ImportError as error:
        first = str(error).split(". ")[0]
        raise DeviceAbsent(f"device force-dimension: {first}; {INSTALL}") from error


def check_result(dhd: Any, result: int, doing: str, cure: str) -> int:
    """Return a result that is not an error. Raises: DeviceError with the library's message and the cure otherwise."""
    if result < 0:
        raise DeviceError(f"Force Dimension, {doing}: {dhd.errorGetLastStr()}; {cure}")
    return result


def take(number: int) -> bool:
    """Mark a device as open; return False if it was open already."""
    with _taking:
        free = number not in OPENED
        OPENED.add(number)
        return free


@final
class ForceDimensionLink(Link):
    """A device in use. The library's x is towards the user, its y right, its z up: our (x, y, z) is its (y, -x, z)."""

    def __init__(self, dhd: Any, number: int, max_force_n: float) -> None:
        super().__init__("this Force Dimension device", max_force_n)
        self._dhd = dhd
        self._number = number
        self._applied = NO_FORCE
        try:
            check_result(dhd, dhd.enableForce(True, number), "enabling its force", REPLUG)
            self._send(NO_FORCE)
        except BaseException:
            self.close()
            raise

    def _read(self) -> HapticState:
        """Return the position of the tip. Raises: DeviceError if the device stopped answering."""
        position, velocity = [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]
        check_result(self._dhd, self._dhd.getPosition(position, self._number), "reading its position", REPLUG)
        if self._dhd.getLinearVelocity(velocity, self._number) < 0:
            velocity = [0.0, 0.0, 0.0]  # the library needs two positions within its window for a velocity
        (x, y, z), (vx, vy, vz) = position, velocity
        if not all(map(math.isfinite, (*position, *velocity))):
            raise DeviceError(f"Force Dimension: its position is {position} m; {REPLUG}")
        buttons = self._dhd.getButtonMask(self._number) & 0xFFFFFFFF
        return HapticState((y, -x, z), (vy, -vx, vz), time.perf_counter(), buttons)

    def _send(self, force: Force) -> None:
        """Set the force. Raises: DeviceError as `_read`."""
        self._applied = NO_FORCE
        result = self._dhd.setForce([-force.y, force.x, force.z], self._number)
        check_result(self._dhd, result, "setting its force", REPLUG)
        self._applied = force

    @property
    def applied(self) -> Force:
        """The force that was set last."""
        return self._applied

    def _release(self) -> None:
        """Close the device."""
        self._dhd.close(self._number)
        OPENED.discard(self._number)
