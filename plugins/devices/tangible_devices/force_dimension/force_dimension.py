"""Force Dimension's devices, and the Falcon by this maker's library, bound by `forcedimension_core.dhd`."""

import io
import math
import time
from collections.abc import Iterator
from contextlib import redirect_stderr
from importlib import import_module
from threading import Lock
from typing import Annotated, Any, Literal, final

from pydantic import Field

from tangible_core.data import NO_FORCE, DeviceSpec, Finding, Force, HapticState, Unit
from tangible_core.errors import DeviceAbsent, DeviceError
from tangible_core.plugins import HapticDevice, Link, Serviceable

Model = Literal["omega", "delta", "sigma", "falcon"]
SPECS: dict[Model, tuple[float, float, float, float]] = {
    "omega": (12.0, 5000.0, 30.0, 0.075),
    "delta": (20.0, 5000.0, 30.0, 0.15),
    "sigma": (12.0, 4000.0, 30.0, 0.075),
    "falcon": (8.0, 3000.0, 20.0, 0.04),
}
"""Greatest force, greatest stiffness, greatest damping and radius of the workspace of each model, in SI units, as in
CHAI3D's table of devices."""
FREE_IT = "close other programs that use it, check its power, and on Linux allow its USB device by the SDK's udev rules"
INSTALL = (
    "install the Force Dimension SDK 3.16 or newer (forcedimension.com), then pip install "
    "forcedimension-core with Python 3.12 or older; FDSDK in the environment may name the SDK's folder"
)
REPLUG = "check its plug and its power, then open it again"
# The devices that this program has open; the library itself would open the same one twice.
OPENED: set[int] = set()
_taking = Lock()


class ForceDimension(HapticDevice, Serviceable):
    """An omega, delta or sigma by Force Dimension, or a Falcon by their library, through forcedimension-core.

    The origin is the middle of the workspace. Torques and grippers are not used.
    """

    serial: Annotated[int, Field(ge=0, le=65535)] | None = None
    """Serial number of the device to open; null selects by `index`."""
    index: Annotated[int, Field(ge=0, le=127)] = 0
    """Number of the device to open, in the library's order from 0, if no serial number is given."""
    model: Model = "omega"
    """Model of the device; its limits must be known before it is opened."""

    def spec(self) -> DeviceSpec:
        """Return the model's limits, as in CHAI3D's table; the resolution is a guess."""
        force_n, stiffness_n_per_m, damping_n_s_per_m, radius_m = SPECS[self.model]
        return DeviceSpec(
            max_force_n=force_n,
            max_stiffness_n_per_m=stiffness_n_per_m,
            damping_n_s_per_m=damping_n_s_per_m,
            workspace_m=(2 * radius_m, 2 * radius_m, 2 * radius_m),
            resolution_m=6e-5 if self.model == "falcon" else 3e-5,
            buttons=32,
        )

    def open(self) -> Link:
        """Open the device. Raises: DeviceAbsent if it or the library is missing, DeviceError if in use or failing."""
        dhd = library()
        if dhd.getDeviceCount() < 1:
            raise DeviceAbsent("Force Dimension: no device is connected; plug it in, and turn it on")
        number = dhd.openID(self.index) if self.serial is None else dhd.openSerial(self.serial)
        which = f"device {self.index}" if self.serial is None else f"the device of serial {self.serial}"
        check_result(dhd, number, f"opening {which}", FREE_IT)
        if not take(number):
            raise DeviceError(f"Force Dimension: this program has {which} open already; close it first")
        return ForceDimensionLink(dhd, number, self.spec().max_force_n)

    def connected(self) -> tuple[Unit, ...]:
        """Open each device for a moment and return its name. Raises: DeviceAbsent if the library is missing."""
        dhd = library()
        return tuple(_unit(dhd, index) for index in range(max(0, dhd.getDeviceCount())))

    def examine(self) -> Iterator[Finding]:
        """Check the library, and whether each device can be opened."""
        try:
            units = self.connected()
        except DeviceAbsent as absent:
            yield Finding("library", "not asked", str(absent))
            return
        yield Finding("library", "fine", "forcedimension-core and the SDK are there")
        for unit in units:
            verdict, cure = ("failed", FREE_IT) if unit.problem else ("fine", "")
            yield Finding(unit.place, verdict, unit.problem or f"{unit.name}, serial number {unit.serial}", cure)
        if not units:
            yield Finding("device", "not asked", "none is connected")


def _unit(dhd: Any, index: int) -> Unit:
    place, number = f"index {index}", dhd.openID(index)
    if number < 0:
        return Unit("Force Dimension", place=place, problem=dhd.errorGetLastStr())
    try:
        serial = dhd.getSerialNumber(number)
        return Unit(dhd.getSystemName(number) or "Force Dimension", "" if serial < 0 else str(serial), place)
    finally:
        if number not in OPENED:
            dhd.close(number)


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
        self._force = NO_FORCE
        try:
            check_result(dhd, dhd.enableForce(True, number), "enabling its force", REPLUG)
            self._send(NO_FORCE)
        except BaseException:
            self.close()
            raise

    def _read(self) -> HapticState:
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
        self._force = NO_FORCE
        result = self._dhd.setForce([-force.y, force.x, force.z], self._number)
        check_result(self._dhd, result, "setting its force", REPLUG)
        self._force = force

    @property
    def applied(self) -> Force:
        """The force that was set last."""
        return self._force

    def _release(self) -> None:
        self._dhd.close(self._number)
        OPENED.discard(self._number)
