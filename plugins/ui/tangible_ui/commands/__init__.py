"""The command `tangible ui`. Every start of `tangible` imports this package, so it imports next to nothing."""

from __future__ import annotations

from typing import TYPE_CHECKING

from tangible_core.plugins import hookimpl

if TYPE_CHECKING:
    from typer import Typer


@hookimpl
def tangible_commands(app: Typer) -> None:
    """Add `tangible ui`."""
    from tangible_core.cli import add

    add(
        "ui", f"{__package__}.ui:ui", "See, hear and feel a surface in the browser.",
        "Begin", "tangible ui photo.jpg",
    )  # fmt: skip
