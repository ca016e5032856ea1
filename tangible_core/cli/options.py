"""Options that several commands have, and the exit codes."""

import sys
from pathlib import Path
from typing import Annotated

import typer

from ..errors import ConfigError
from . import completing

DONE, FAILED, MISTAKE, INTERRUPTED = 0, 1, 2, 130

Config = Annotated[
    Path,
    typer.Argument(
        metavar="FILE",
        help="Pipeline file (YAML), or a picture.",
        show_default=False,
        autocompletion=completing.scenes,
    ),
]
ConfigOrPictures = Annotated[
    list[Path],
    typer.Argument(
        metavar="FILE...",
        help="Pipeline file (YAML), a picture, or left and right.",
        show_default=False,
        autocompletion=completing.scenes,
    ),
]
Sets = Annotated[
    list[str] | None,
    typer.Option(
        "--set", metavar="KEY.KEY=VALUE", help="Set one value of the file; repeatable.", autocompletion=completing.keys
    ),
]
Json = Annotated[bool, typer.Option("--json", help="Print JSON, for programs.")]
NoCache = Annotated[bool, typer.Option("--no-cache", help="Neither read nor write the cache of results.")]
Verbose = Annotated[
    bool, typer.Option("--verbose", "-v", help="Also list what became of each product, why, and all figures.")
]
Yes = Annotated[bool, typer.Option("--yes", "-y", help="Skip the confirmation when the depth map is unreliable.")]
Record = Annotated[Path | None, typer.Option(help="Save every tick to this file (.nc, .npz or .csv).")]


def ask(question: str, refusal: str, default: bool = False) -> None:
    """Ask a question on the terminal. Raises: ConfigError with the refusal if there is no terminal, Exit for a no."""
    if sys.stdin is None or not sys.stdin.isatty():
        raise ConfigError(refusal)
    if not typer.confirm(question, err=True, default=default):
        raise typer.Exit


def is_listing(group: str, subcommand: str | None, as_json: bool) -> bool:
    """Return True if a group is called without a subcommand. Raises: ConfigError for --json before a subcommand."""
    if subcommand and as_json:
        raise ConfigError(f"{group}: write --json after {subcommand!r}")
    return not subcommand
