"""The commands for studies. They are listed at each start of `tangible`, so this room imports next to nothing."""

from __future__ import annotations

from typing import TYPE_CHECKING

from tangible_core.plugins import hookimpl

if TYPE_CHECKING:
    from tangible_core.plugins.registry import Listing


@hookimpl
def tangible_commands() -> None:
    """Add `tangible study`."""
    from tangible_core.cli import add

    add(
        "study", "tangible_study.commands.study:app", "Run an experiment with people from a file; check it first.",
        "Compare", "tangible study check mine.yaml",
    )  # fmt: skip


@hookimpl
def tangible_listings() -> list[Listing]:
    """List the installed procedures."""
    from ..points import procedure_listings

    return procedure_listings()
