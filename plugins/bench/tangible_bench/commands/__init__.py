"""The command that compares methods. Imported whenever `tangible` starts, so this room imports next to nothing."""

from __future__ import annotations

from typing import TYPE_CHECKING

from tangible_core.plugins import hookimpl

if TYPE_CHECKING:
    from typer import Typer


@hookimpl
def tangible_commands(app: Typer) -> None:
    """Add `tangible compare`."""
    from tangible_core.cli import add

    add(
        "compare", "tangible_bench.commands.compare:compare", "Compare methods by time, memory and error.",
        "Compare", "tangible compare semi-global zncc",
    )  # fmt: skip
