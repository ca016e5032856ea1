"""The command that shows materials. It is imported at each start of `tangible`, so it imports next to nothing."""

from __future__ import annotations

from typing import TYPE_CHECKING

from tangible_core.plugins import hookimpl

if TYPE_CHECKING:
    from typer import Typer


@hookimpl
def tangible_commands(app: Typer) -> None:
    """Add `tangible materials`."""
    from tangible_core.cli import add

    add("materials", "tangible_report.commands.materials:app", "List the materials; show or draw some.")
