"""`devices`: what is installed and connected, what is wrong with it, homing and calibration."""

from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any, cast

from rich.markup import escape

from ..data import Finding, Unit
from ..errors import ConfigError, DeviceError, TangibleError
from ..files.source import parse_source
from ..plugins.interfaces import Adjustable, HapticDevice, Serviceable
from ..plugins.registry import Listing, default_registry
from ..scene.calibrations import save_calibration
from . import show

COLOURS = {"fine": "green", "failed": "red", "not asked": "dim"}


def devices(as_json: bool) -> None:
    """Every installed device, and the units of it that are there."""
    rows = [_row(each) for each in default_registry().listings if each.kind == "device"]
    if as_json:
        show.print_json(rows)
        return
    cells = [(row["name"], *map(escape, cell)) for row in rows for cell in _cells(row)]
    show.table(("device", "connected", "serial", "where", "to do"), cells)


def doctor(name: str | None, sets: Sequence[str], as_json: bool) -> bool:
    """Examine one device or all; True if nothing failed. Of one that is named, what cannot be asked has failed too."""
    if name is None and sets:
        raise ConfigError("--set: name the device that has this option")
    names = [name] if name else [each.name for each in default_registry().listings if each.kind == "device"]
    found = {each: _findings(each, sets, named=name is not None) for each in names}
    verdicts = {each.verdict for findings in found.values() for each in findings}
    if as_json:
        show.print_json({each: [asdict(finding) for finding in findings] for each, findings in found.items()})
    else:
        _tell(found)
    return "failed" not in verdicts and not (name and "not asked" in verdicts)


def home(name: str, sets: Sequence[str]) -> None:
    """Guide the user until the device knows where it is."""
    _adjustable(name, sets).home(show.note)
    show.say(f"{name} is homed")


def calibrate(name: str, sets: Sequence[str]) -> None:
    """Measure one unit with the user's help, and keep it by its serial number."""
    serial, values = _adjustable(name, sets).calibrate(_ask)
    path = save_calibration(name, serial, values)
    show.table(("of this unit", "value"), [(key, str(value)) for key, value in values.model_dump(mode="json").items()])
    show.plain(f"\nsaved in {path}")


def make(name: str, sets: Sequence[str]) -> HapticDevice:
    """An installed device with options as `key=value`.

    Raises: UnknownMethod, BrokenMethod, ConfigError with every complaint of the options.
    """
    cls = default_registry().load("device", name)
    source = parse_source("{}", Path(f"device {name}"), "options are key=value", sets)
    device = source.model((), cls, dict(source.tree))
    source.settle()
    return cast(HapticDevice, device)


def _adjustable(name: str, sets: Sequence[str]) -> Adjustable:
    device = make(name, sets)
    if not isinstance(device, Adjustable):
        raise DeviceError(f"device {name} has nothing to home or to calibrate; it can be used as it is")
    return device


def _row(listing: Listing) -> dict[str, Any]:
    """One installed device: whether it is simulated, its units, and why they cannot be told."""
    row: dict[str, Any] = {"name": listing.name, "origin": listing.origin, "summary": listing.summary}
    row |= {"simulated": None, "units": [], "problem": ""}
    try:
        device = make(listing.name, ())
        row["simulated"] = device.spec().simulated
        row["units"] = [asdict(unit) for unit in device.connected()] if isinstance(device, Serviceable) else []
    except TangibleError as error:
        row["problem"] = str(error)
    return row


def _cells(row: dict[str, Any]) -> list[tuple[str, str, str, str]]:
    """What is shown of a device: a line a unit, or one that says why there is none."""
    units = [Unit(**unit) for unit in row["units"]]
    if units:
        return [(unit.name, unit.serial, unit.place, unit.problem) for unit in units]
    return [("simulated" if row["simulated"] else "-", "", "", row["problem"])]


def _findings(name: str, sets: Sequence[str], named: bool) -> list[Finding]:
    try:
        device = make(name, sets)
    except TangibleError as error:
        if named:
            raise
        return [Finding("plugin", "failed", str(error))]
    if isinstance(device, Serviceable):
        return list(device.examine())
    return [Finding("device", "fine", "needs nothing" if device.spec().simulated else "offers no examination")]


def _tell(found: dict[str, list[Finding]]) -> None:
    rows = [
        (name, each.check, f"[{COLOURS[each.verdict]}]{each.verdict}[/]", escape(each.says))
        for name, findings in found.items()
        for each in findings
    ]
    show.table(("device", "check", "verdict", "says"), rows)
    for name, findings in found.items():
        for each in findings:
            if each.verdict == "failed" and each.cure:
                show.say(f"\n[bold]{name}, {escape(each.check)}[/]")
                show.plain(each.cure)


def _ask(text: str) -> str:
    show.note(text)
    try:
        return input("> ").strip()
    except EOFError as error:
        raise ConfigError("the calibration ended without an answer; nothing was saved") from error
