"""Force Dimension's devices: omega, delta, sigma, and the Falcon by this maker's library."""

from collections.abc import Iterator
from typing import Annotated, Any, Literal

from pydantic import Field

from tangible_core.data import DeviceSpec, Finding, Unit
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
        from .link import ForceDimensionLink, check_result, library, take

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
        from .link import library

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
    from .link import OPENED

    place, number = f"index {index}", dhd.openID(index)
    if number < 0:
        return Unit("Force Dimension", place=place, problem=dhd.errorGetLastStr())
    try:
        serial = dhd.getSerialNumber(number)
        return Unit(dhd.getSystemName(number) or "Force Dimension", "" if serial < 0 else str(serial), place)
    finally:
        if number not in OPENED:
            dhd.close(number)
