"""Options that several commands have, and the exit codes."""

from pathlib import Path
from typing import Annotated

import typer

DONE, FAILED, MISTAKE, INTERRUPTED = 0, 1, 2, 130

Config = Annotated[Path, typer.Argument(help="A pipeline file (YAML).", show_default=False)]
Sets = Annotated[
    list[str] | None, typer.Option("--set", metavar="KEY.KEY=VALUE", help="Override one value; repeatable.")
]
Out = Annotated[Path | None, typer.Option("--out", help="Folder for results [default: out/NAME].")]
Json = Annotated[bool, typer.Option("--json", help="Print JSON for a program to read.")]
NoCache = Annotated[bool, typer.Option("--no-cache", help="Neither read nor keep results between runs.")]
Seconds = Annotated[float, typer.Option(help="How long the hand feels the surface.")]
