"""`tangible devices ...`: what is installed and connected, what is wrong with it, homing and calibration."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any

import typer

from ...errors import ConfigError
from .. import completing
from ..options import FAILED, Json

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ...data import Finding
    from ...plugins.interfaces import Adjustable

COLOURS = {"fine": "green", "failed": "red", "not asked": "dim"}
Device = Annotated[
    str,
    typer.Argument(help="As `tangible devices` lists it.", show_default=False, autocompletion=completing.devices),
]
DeviceSets = Annotated[
    list[str] | None, typer.Option("--set", metavar="KEY=VALUE", help="Set an option of the device; repeatable.")
]

app = typer.Typer(name="devices", rich_markup_mode=None, add_completion=False)


@app.callback(invoke_without_command=True)
def devices(context: typer.Context, as_json: Json = False) -> None:
    """List devices; examine, home or calibrate one."""
    if context.invoked_subcommand is not None:
        if as_json:
            raise ConfigError(f"devices: write --json after {context.invoked_subcommand!r}")
        return
    from dataclasses import asdict

    from rich.markup import escape

    from ...plugins.devices import installed_devices
    from ...plugins.registry import default_registry
    from .. import sentences, show

    rows = [asdict(each) for each in installed_devices(default_registry())]
    if as_json:
        show.print_json(rows)
        return
    show.sentence(sentences.connected(rows))
    cells = [(row["name"], *map(escape, cell)) for row in rows for cell in _cells(row)]
    show.table(("device", "connected", "serial", "where", "to do"), cells)


@app.command()
def doctor(
    name: Annotated[
        str | None,
        typer.Argument(help="The device [default: all].", show_default=False, autocompletion=completing.devices),
    ] = None,
    sets: DeviceSets = None,
    as_json: Json = False,
) -> None:
    """Say what keeps a device from working, and the cure.

    Permissions, drivers, firmware. Exit 1 if a check fails; of a device that is named, what cannot be asked has failed.
    """
    from dataclasses import asdict

    from ...plugins.registry import default_registry
    from .. import sentences, show

    if name is None and sets:
        raise ConfigError("--set: name the device that has this option")
    names = [name] if name else [each.name for each in default_registry().listings if each.kind == "device"]
    found = {each: _findings(each, sets or [], named=name is not None) for each in names}
    verdicts = [each.verdict for findings in found.values() for each in findings]
    if as_json:
        show.print_json({each: [asdict(finding) for finding in findings] for each, findings in found.items()})
    else:
        show.sentence(sentences.diagnosed(name, verdicts))
        _tell(found)
    if "failed" in verdicts or (name and "not asked" in verdicts):
        raise typer.Exit(FAILED)


@app.command()
def home(name: Device, sets: DeviceSets = None) -> None:
    """Guide your hand until the device knows its position."""
    from .. import show

    _adjustable(name, sets or []).home(show.note)
    show.say(f"{name} is homed")


@app.command()
def calibrate(name: Device, sets: DeviceSets = None) -> None:
    """Measure one device with your help.

    What was measured is kept for its serial number.
    """
    from ...mapping.device_calibrations import save_calibration
    from .. import show

    serial, values = _adjustable(name, sets or []).calibrate(_ask)
    path = save_calibration(name, serial, values)
    show.table(("of this unit", "value"), [(key, str(value)) for key, value in values.model_dump(mode="json").items()])
    show.plain(f"\nsaved in {path}")


@app.command()
def stress(
    name: Device,
    sets: DeviceSets = None,
    seconds: Annotated[float, typer.Option(help="How long, s.")] = 5.0,
    as_json: Json = False,
) -> None:
    """Measure how fast a device can be read and written.

    No force is given. Rate, and percentiles of the time of one cycle.
    """
    from ...plugins.devices import make_device
    from ...plugins.registry import default_registry
    from ...session.stress import stress_device
    from .. import sentences, show

    if not 0 < seconds <= 3600:
        raise ConfigError(f"--seconds {seconds}: is above 0, and at most an hour")
    figures = {"device": name, **stress_device(make_device(default_registry(), name, sets or []), seconds)}
    if as_json:
        show.print_json(figures)
    else:
        texts = [(key, f"{value:.1f}" if isinstance(value, float) else str(value)) for key, value in figures.items()]
        show.sentence(sentences.stressed(figures))
        show.table(("figure", "value"), texts)


def _adjustable(name: str, sets: Sequence[str]) -> Adjustable:
    from ...errors import DeviceError
    from ...plugins.devices import make_device
    from ...plugins.interfaces import Adjustable
    from ...plugins.registry import default_registry

    device = make_device(default_registry(), name, sets)
    if not isinstance(device, Adjustable):
        raise DeviceError(f"device {name} has nothing to home or to calibrate; it can be used as it is")
    return device


def _cells(row: dict[str, Any]) -> list[tuple[str, str, str, str]]:
    """What is shown of a device: a line a unit, or one that says why there is none."""
    from ...data import Unit

    units = [Unit(**unit) for unit in row["units"]]
    if units:
        return [(unit.name, unit.serial, unit.place, unit.problem) for unit in units]
    return [("simulated" if row["simulated"] else "-", "", "", row["problem"])]


def _findings(name: str, sets: Sequence[str], named: bool) -> Sequence[Finding]:
    from ...data import Finding
    from ...errors import TangibleError
    from ...plugins.devices import examine_device
    from ...plugins.registry import default_registry

    try:
        return examine_device(default_registry(), name, sets)
    except TangibleError as error:
        if named:
            raise
        return [Finding("plugin", "failed", str(error))]


def _tell(found: dict[str, Sequence[Finding]]) -> None:
    from rich.markup import escape

    from .. import show

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
    from ...errors import ConfigError
    from .. import show

    show.note(text)
    try:
        return input("> ").strip()
    except EOFError as error:
        raise ConfigError("the calibration ended without an answer; nothing was saved") from error
