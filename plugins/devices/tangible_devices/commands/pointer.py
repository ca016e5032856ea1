"""`tangible pointer`: move a pointer device from the command line, and see the forces."""

from typing import Annotated

import typer

PATHS = "circle | raster | spiral | press"


def pointer(
    path: Annotated[str, typer.Option(help=f"{PATHS}; without one, type positions.")] = "",
    channel: Annotated[str, typer.Option(help="Channel, as in the device's options.")] = "pointer",
    seconds: Annotated[float, typer.Option(help="How long to follow the path, s.")] = 8.0,
    height_mm: Annotated[float, typer.Option(help="Height of the path above the base plane, mm.")] = 5.0,
    speed_mm_per_s: Annotated[float, typer.Option(help="Speed along the path, mm/s.")] = 80.0,
    wait: Annotated[float, typer.Option(help="How long to wait for the device, s.")] = 0.0,
    as_json: Annotated[bool, typer.Option("--json", help="One JSON object a line.")] = False,
) -> None:
    """Move a `pointer` device from another terminal.

    Shows the forces. Typed positions are lines of `x y z`, millimetres, and buttons as a fourth number if you like.
    """
    from ..pointer.following import follow

    for line in follow(path, channel, seconds, height_mm / 1000, speed_mm_per_s / 1000, wait, as_json):
        print(line, flush=True)  # noqa: T201
