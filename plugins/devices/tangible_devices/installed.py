"""The installed devices, their connected units and the problems of each; and how fast one can be read and written."""

import time
from array import array
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, cast

from tangible_core.data import NO_FORCE, Finding, Unit
from tangible_core.errors import TangibleError
from tangible_core.files.yaml import parse_source
from tangible_core.plugins import HapticDevice, Serviceable
from tangible_core.plugins.failures import sentence
from tangible_core.plugins.registry import Listing, Registry

WARM_UP = 100
MAX_CYCLES = 10_000_000  # greatest number of cycles, as all of their times are in memory


@dataclass(frozen=True)
class InstalledDevice:
    """A device that is installed, with its connected units."""

    name: str  # the name for `device: {use: ...}`
    origin: str
    summary: str
    # True for a simulated device; None where this is unknown because of the `problem`.
    simulated: bool | None = None
    units: tuple[Unit, ...] = ()  # the units that are connected now, each with the problem that it has, if any
    problem: str = ""  # the reason why it cannot be looked for; empty if it can

    @property
    def usable(self) -> bool:
        """True if it is simulated, or if a unit without a problem is connected."""
        return bool(self.simulated) or any(not unit.problem for unit in self.units)


def installed_devices(registry: Registry) -> tuple[InstalledDevice, ...]:
    """List every installed device with its connected units; a device that fails is a row with a problem."""
    return tuple(_look_for(listing, registry) for listing in registry.listings if listing.kind == "device")


def make_device(registry: Registry, name: str, sets: Sequence[str] = ()) -> HapticDevice:
    """Make an installed device with options as `key=value`, unopened. Raises: BrokenMethod, ConfigError."""
    cls = registry.load("device", name)
    source = parse_source("{}", Path(f"device {name}"), "options are key=value", sets)
    device = source.model((), cls, dict(source.tree))
    source.settle()
    return cast(HapticDevice, device)


def examine_device(registry: Registry, name: str, sets: Sequence[str] = ()) -> tuple[Finding, ...]:
    """Check all that this device needs to be opened, in the order in which to correct it. Raises: as `make_device`."""
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


def stress_device(device: HapticDevice, seconds: float) -> dict[str, Any]:
    """Measure the rate, and percentiles of the time of one read and one write. Raises: DeviceError as the device."""
    import numpy as np

    spent_ns = array("q")
    with device.open() as link:
        for _ in range(WARM_UP):
            link.read()
            link.write(NO_FORCE)
        start = last = time.perf_counter_ns()
        end = start + round(seconds * 1e9)
        while last < end and len(spent_ns) < MAX_CYCLES:
            link.read()
            link.write(NO_FORCE)
            now = time.perf_counter_ns()
            spent_ns.append(now - last)
            last = now
    spent_us = np.array(spent_ns) / 1e3
    p50, p99, p999 = np.percentile(spent_us, (50, 99, 99.9)).tolist()
    return {
        "cycles": spent_us.size,
        "rate_hz": 1e9 * spent_us.size / (last - start),
        "p50_us": p50,
        "p99_us": p99,
        "p99_9_us": p999,
        "max_us": float(spent_us.max()),
    }


def _look_for(listing: Listing, registry: Registry) -> InstalledDevice:
    facts = listing.name, listing.origin, listing.summary
    is_simulated = None
    try:
        device = make_device(registry, listing.name)
        is_simulated = device.spec().simulated
        units = device.connected() if isinstance(device, Serviceable) else ()
        return InstalledDevice(*facts, is_simulated, tuple(units))
    except Exception as error:  # noqa: BLE001 - the other devices are listed all the same
        return InstalledDevice(*facts, is_simulated, problem=_message(error))


def _message(error: Exception) -> str:
    return str(error) if isinstance(error, TangibleError) else sentence(error)
