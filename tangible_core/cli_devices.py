"""`tangible devices ...`."""

from typing import Annotated

import typer

from .cli_options import FAILED, Json
from .errors import ConfigError

devices_app = typer.Typer(name="devices")

Device = Annotated[str, typer.Argument(help="As `tangible devices` lists it.", show_default=False)]
DeviceSets = Annotated[
    list[str] | None, typer.Option("--set", metavar="KEY=VALUE", help="An option of the device; repeatable.")
]


@devices_app.callback(invoke_without_command=True)
def devices(context: typer.Context, as_json: Json = False) -> None:
    """List the devices, installed and connected; examine, home, calibrate or time one."""
    from .commands import devices as command

    if context.invoked_subcommand is None:
        command.devices(as_json)
    elif as_json:
        raise ConfigError(f"devices: write --json after {context.invoked_subcommand!r}")


@devices_app.command("doctor")
def devices_doctor(
    name: Annotated[str | None, typer.Argument(help="The device [default: all].", show_default=False)] = None,
    sets: DeviceSets = None,
    as_json: Json = False,
) -> None:
    """Say what keeps a device from working, and the cure: permissions, drivers, firmware; exit 1 if a check fails."""
    from .commands import devices as command

    if not command.doctor(name, sets or [], as_json):
        raise typer.Exit(FAILED)


@devices_app.command("home")
def devices_home(name: Device, sets: DeviceSets = None) -> None:
    """Guide your hand until the device knows where it is."""
    from .commands import devices as command

    command.home(name, sets or [])


@devices_app.command("calibrate")
def devices_calibrate(name: Device, sets: DeviceSets = None) -> None:
    """Measure one device with your help, and keep that for its serial number."""
    from .commands import devices as command

    command.calibrate(name, sets or [])


@devices_app.command("stress")
def devices_stress(
    name: Device,
    sets: DeviceSets = None,
    seconds: Annotated[float, typer.Option(help="How long.")] = 5.0,
    as_json: Json = False,
) -> None:
    """Read a device and write no force as fast as it allows: rate, and percentiles of a cycle's time."""
    from .commands import stress as command

    command.stress(name, sets or [], seconds, as_json)
