"""`tangible pointer`: move a pointer device from the command line, and see the forces."""

import sys
from typing import Annotated

import typer

PATHS = "circle | raster | spiral | press"


def pointer(
    path: Annotated[str, typer.Option(help=f"Path to follow: {PATHS}; without one, type positions.")] = "",
    channel: Annotated[str, typer.Option(help="Channel, the same as the device's.")] = "pointer",
    seconds: Annotated[float, typer.Option(help="Time on the path, s.")] = 8.0,
    height_mm: Annotated[float, typer.Option(help="Height of the path above the base plane, mm.")] = 5.0,
    speed_mm_per_s: Annotated[float, typer.Option(help="Speed along the path, mm/s.")] = 80.0,
    wait: Annotated[float, typer.Option(help="Time to wait for the device, s.")] = 0.0,
    as_json: Annotated[bool, typer.Option("--json", help="Print one JSON object per line.")] = False,
) -> None:
    """Move a `pointer` device by hand and see the forces.

    Typed positions are lines of `x y z` in millimetres, with the buttons as an optional fourth number. A
    line that is not a position gives a message, and the next one may be typed.
    """
    from tangible_core.runtime import stream

    from ..pointer.following import follow

    def complain(text: str) -> None:
        print(text, file=sys.stderr, flush=True)  # noqa: T201

    for line in follow(path, channel, seconds, height_mm / 1000, speed_mm_per_s / 1000, wait, as_json, complain):
        print(line, file=stream(), flush=True)
