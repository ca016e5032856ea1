"""The commands that devices add to `tangible`; imported at every start of it, so that this imports next to nothing."""

from __future__ import annotations

from typing import TYPE_CHECKING

from tangible_core.plugins import hookimpl

if TYPE_CHECKING:
    from typer import Typer


@hookimpl
def tangible_commands(app: Typer) -> None:
    """Add `tangible pointer`."""
    from .pointer import pointer

    app.command()(pointer)
