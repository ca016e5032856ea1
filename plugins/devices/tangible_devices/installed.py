"""The installed devices, their connected units and the problems of each; none is opened."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import cast

from tangible_core.data import Finding, Unit
from tangible_core.errors import TangibleError
from tangible_core.files.yaml.source import parse_source
from tangible_core.plugins.failures import sentence
from tangible_core.plugins.interfaces import HapticDevice, Serviceable
from tangible_core.plugins.registry import Listing, Registry


@dataclass(frozen=True)
class InstalledDevice:
    """A device that is installed, with its connected units."""

    name: str
    """The name for `device: {use: ...}`."""
    origin: str
    summary: str
    simulated: bool | None = None
    """True for a simulated device; None where this is unknown because of the `problem`."""
    units: tuple[Unit, ...] = ()
    """The units that are connected now, each with the problem that it has, if any."""
    problem: str = ""
    """The reason why it cannot be looked for; empty if it can."""

    @property
    def usable(self) -> bool:
        """True if it is simulated, or if a unit without a problem is connected."""
        return bool(self.simulated) or any(not unit.problem for unit in self.units)


def installed_devices(registry: Registry) -> tuple[InstalledDevice, ...]:
    """List every installed device with its connected units; a device that fails is a row with a problem."""
    return tuple(_look_for(each, registry) for each in registry.listings if each.kind == "device")


def make_device(registry: Registry, name: str, sets: Sequence[str] = ()) -> HapticDevice:
    """Make an installed device with options as `key=value`, without opening it.

    Raises: UnknownMethod, BrokenMethod, ConfigError with every complaint of the options.
    """
    cls = registry.load("device", name)
    source = parse_source("{}", Path(f"device {name}"), "options are key=value", sets)
    device = source.model((), cls, dict(source.tree))
    source.settle()
    return cast(HapticDevice, device)


def examine_device(registry: Registry, name: str, sets: Sequence[str] = ()) -> tuple[Finding, ...]:
    """Check everything that this device needs before it can be opened, in the order in which to correct it.

    An error of the device becomes the last finding. Raises: as `make_device`.
    """
    device, findings = make_device(registry, name, sets), list[Finding]()
    try:
        if not isinstance(device, Serviceable):
            text = "needs nothing" if device.spec().simulated else "offers no examination"
            return (Finding("device", "fine", text),)
        for finding in device.examine():
            findings.append(finding)
    except Exception as error:  # noqa: BLE001 - a device's own failure is a finding
        findings.append(Finding("plugin", "failed", _message(error)))
    return tuple(findings)


def _look_for(listing: Listing, registry: Registry) -> InstalledDevice:
    known = listing.name, listing.origin, listing.summary
    simulated = None
    try:
        device = make_device(registry, listing.name)
        simulated = device.spec().simulated
        units = device.connected() if isinstance(device, Serviceable) else ()
        return InstalledDevice(*known, simulated, tuple(units))
    except Exception as error:  # noqa: BLE001 - the other devices are listed all the same
        return InstalledDevice(*known, simulated, problem=_message(error))


def _message(error: Exception) -> str:
    return str(error) if isinstance(error, TangibleError) else sentence(error)
