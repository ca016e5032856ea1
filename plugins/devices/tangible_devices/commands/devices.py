"""The command `devices`: list, diagnose, home, calibrate and measure devices."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from typing import TYPE_CHECKING, Annotated, Any

import typer

from tangible_core.cli import FAILED, Json, completing, is_listing, listing, show
from tangible_core.errors import ConfigError, DeviceError, TangibleError
from tangible_core.plugins.registry import default_registry

if TYPE_CHECKING:
    from tangible_core.data import Finding
    from tangible_core.plugins import Adjustable

COLOURS = {"fine": "green", "failed": "red", "not asked": "dim"}
Device = Annotated[
    str,
    typer.Argument(
        metavar="NAME", help="As `tangible devices` lists it.", show_default=False, autocompletion=completing.devices
    ),
]
DeviceSets = Annotated[
    list[str] | None, typer.Option("--set", metavar="KEY=VALUE", help="Set an option of the device; repeatable.")
]

app: typer.Typer = typer.Typer(name="devices", rich_markup_mode=None, add_completion=False)


@app.callback(invoke_without_command=True)
def devices(context: typer.Context, as_json: Json = False) -> None:
    """List devices; examine, home or calibrate one."""
    if not is_listing("devices", context.invoked_subcommand, as_json):
        return

    from ..installed import installed_devices

    rows = [asdict(device) for device in installed_devices(default_registry())]
    if as_json:
        show.print_json(rows)
        return
    show.sentence(_devices_summary(rows))
    cells = [(row["name"], *map(show.escape, cell)) for row in rows for cell in _cells(row)]
    show.table(("device", "connected", "serial", "where", "to do"), cells)


@app.command()
def doctor(
    name: Annotated[
        str | None,
        typer.Argument(
            metavar="NAME", help="The device [default: all].", show_default=False, autocompletion=completing.devices
        ),
    ] = None,
    sets: DeviceSets = None,
    as_json: Json = False,
) -> None:
    """Find what keeps a device from working, and the cure.

    Checks permissions, drivers, firmware. Exit 1 if a check fails, or if one of a named device cannot be made.
    """
    if name is None and sets:
        raise ConfigError("--set: name the device that has this option")
    names = [name] if name else [entry.name for entry in default_registry().listings if entry.kind == "device"]
    results = {device: _findings(device, sets or [], is_request=name is not None) for device in names}
    verdicts = [finding.verdict for findings in results.values() for finding in findings]
    if as_json:
        show.print_json({device: [asdict(finding) for finding in findings] for device, findings in results.items()})
    else:
        show.sentence(_doctor_summary(name, verdicts))
        _print_findings(results)
    if "failed" in verdicts or (name and "not asked" in verdicts):
        raise typer.Exit(FAILED)


@app.command()
def home(name: Device, sets: DeviceSets = None) -> None:
    """Guide your hand until the device knows its position."""
    _adjustable(name, sets or []).home(show.note)
    show.say(f"{name} is homed")


@app.command()
def calibrate(name: Device, sets: DeviceSets = None) -> None:
    """Measure one device with your help.

    The calibration is saved under its serial number.
    """
    from ..device_calibrations import save_calibration

    serial, values = _adjustable(name, sets or []).calibrate(_ask)
    path = save_calibration(name, serial, values)
    show.table(("calibration", "value"), [(key, str(value)) for key, value in values.model_dump(mode="json").items()])
    show.plain(f"\nsaved in {path}")


@app.command()
def stress(
    name: Device,
    sets: DeviceSets = None,
    seconds: Annotated[float, typer.Option(help="Duration, s.")] = 5.0,
    as_json: Json = False,
) -> None:
    """Measure how fast a device can be read and written.

    No force is given. Rate, and percentiles of the time of one cycle.
    """
    from ..installed import make_device, stress_device

    if not 0 < seconds <= 3600:
        raise ConfigError(f"--seconds {seconds}: must be above 0 and at most 3600")
    figures = {"device": name, **stress_device(make_device(default_registry(), name, sets or []), seconds)}
    if as_json:
        show.print_json(figures)
    else:
        texts = [(key, f"{value:.1f}" if isinstance(value, float) else str(value)) for key, value in figures.items()]
        rate = f"{figures['device']} can be read and written {figures['rate_hz']:.0f} times a second"
        show.sentence(f"{rate}; a force loop does so 1000 times.")
        show.table(("figure", "value"), texts)


def _adjustable(name: str, sets: Sequence[str]) -> Adjustable:
    from tangible_core.plugins import Adjustable

    from ..installed import make_device

    device = make_device(default_registry(), name, sets)
    if not isinstance(device, Adjustable):
        raise DeviceError(f"device {name} has nothing to home or to calibrate; it can be used as it is")
    return device


def _cells(row: dict[str, Any]) -> list[tuple[str, str, str, str]]:
    """Return a row for each unit of a device, or one with the reason why there is none."""
    from tangible_core.data import Unit

    units = [Unit(**unit) for unit in row["units"]]
    if units:
        return [(unit.name, unit.serial, unit.place, unit.problem) for unit in units]
    return [("simulated" if row["simulated"] else "-", "", "", row["problem"])]


def _findings(name: str, sets: Sequence[str], is_request: bool) -> Sequence[Finding]:
    from tangible_core.data import Finding

    from ..installed import examine_device

    try:
        return examine_device(default_registry(), name, sets)
    except TangibleError as error:
        if is_request:
            raise
        return [Finding("plugin", "failed", str(error))]


def _print_findings(results: dict[str, Sequence[Finding]]) -> None:
    rows = [
        (name, finding.check, f"[{COLOURS[finding.verdict]}]{finding.verdict}[/]", show.escape(finding.says))
        for name, findings in results.items()
        for finding in findings
    ]
    show.table(("device", "check", "verdict", "finding"), rows)
    for name, findings in results.items():
        for finding in findings:
            if finding.verdict == "failed" and finding.cure:
                show.say(f"\n[bold]{name}, {show.escape(finding.check)}[/]")
                show.plain(finding.cure)


def _ask(text: str) -> str:
    show.note(text)
    try:
        return input("> ").strip()
    except EOFError as error:
        raise ConfigError("the calibration ended without an answer; nothing was saved") from error


def _devices_summary(rows: Sequence[Mapping[str, Any]]) -> str:
    """Return which devices can be felt now."""
    real = [row["name"] for row in rows if row["units"]]
    simulators = [row["name"] for row in rows if row["simulated"]]
    text = f"{listing(real)} {'is' if len(real) == 1 else 'are'} connected" if real else "No real device is connected"
    return f"{text}; {listing(simulators)} need none." if simulators else f"{text}."


def _doctor_summary(name: str | None, verdicts: Sequence[str]) -> str:
    """Return the number of problems that keep a device, or any device, from working."""
    failed, omissions = verdicts.count("failed"), verdicts.count("not asked")
    if failed:
        return f"{_checks(failed)} failed; each has its cure below."
    text = f"Nothing was found that keeps {name or 'a device'} from working"
    return f"{text}, but {_checks(omissions)} could not be made." if omissions else f"{text}."


def _checks(count: int) -> str:
    return f"{count} {'check' if count == 1 else 'checks'}"
