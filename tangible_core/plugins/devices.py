"""Installed devices: which are there, which are connected, and what keeps one from working; none of them is opened."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import cast

from ..data import Finding, Unit
from ..errors import TangibleError
from ..files.yaml.source import parse_source
from .failures import sentence
from .interfaces import HapticDevice, Serviceable
from .registry import Listing, Registry


@dataclass(frozen=True)
class InstalledDevice:
    """A device that is installed, and whether it can be felt now."""

    name: str
    """What `device: {use: ...}` says."""
    origin: str
    summary: str
    simulated: bool | None = None
    """None where it cannot be told, for the `problem`."""
    units: tuple[Unit, ...] = ()
    """Those that are connected now, each with why it cannot be used as it is."""
    problem: str = ""
    """Why it cannot be looked for; empty if it can."""

    @property
    def usable(self) -> bool:
        """Whether it is simulated, or a unit of it is connected and has no problem."""
        return bool(self.simulated) or any(not unit.problem for unit in self.units)


def installed_devices(registry: Registry) -> tuple[InstalledDevice, ...]:
    """Every installed device, and its units that are connected; one that fails costs its own row."""
    return tuple(_installed(each, registry) for each in registry.listings if each.kind == "device")


def make_device(registry: Registry, name: str, sets: Sequence[str] = ()) -> HapticDevice:
    """An installed device with options as `key=value`; it is not opened.

    Raises: UnknownMethod, BrokenMethod, ConfigError with every complaint of the options.
    """
    cls = registry.load("device", name)
    source = parse_source("{}", Path(f"device {name}"), "options are key=value", sets)
    device = source.model((), cls, dict(source.tree))
    source.settle()
    return cast(HapticDevice, device)


def examined(registry: Registry, name: str, sets: Sequence[str] = ()) -> tuple[Finding, ...]:
    """What must be right before this device can be opened, in the order in which to put it right, and whether it is.

    What fails meanwhile is the last finding. Raises: as `make_device`.
    """
    device, found = make_device(registry, name, sets), list[Finding]()
    try:
        if not isinstance(device, Serviceable):
            says = "needs nothing" if device.spec().simulated else "offers no examination"
            return (Finding("device", "fine", says),)
        for finding in device.examine():
            found.append(finding)
    except Exception as error:  # noqa: BLE001 - a device's own failure is what is asked for
        found.append(Finding("plugin", "failed", _said(error)))
    return tuple(found)


def _installed(listing: Listing, registry: Registry) -> InstalledDevice:
    said = listing.name, listing.origin, listing.summary
    simulated = None
    try:
        device = make_device(registry, listing.name)
        simulated = device.spec().simulated
        units = device.connected() if isinstance(device, Serviceable) else ()
        return InstalledDevice(*said, simulated, tuple(units))
    except Exception as error:  # noqa: BLE001 - one that fails costs its own row
        return InstalledDevice(*said, simulated, problem=_said(error))


def _said(error: Exception) -> str:
    return str(error) if isinstance(error, TangibleError) else sentence(error)
