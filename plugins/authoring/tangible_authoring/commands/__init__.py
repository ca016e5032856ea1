"""The commands that prepare a pipeline file. Imported whenever `tangible` starts, so it imports next to nothing."""

from __future__ import annotations

from typing import TYPE_CHECKING

from tangible_core.plugins import hookimpl

if TYPE_CHECKING:
    from collections.abc import Mapping

    from typer import Typer


@hookimpl
def tangible_legibility() -> Mapping[str, str]:
    """Name the rules of tactile graphics, and parts simplified by them."""
    return {
        "judge": "tangible_legibility.legible:legibility",
        "simplify": "tangible_legibility.simplifying.simplify:simplify",
    }


@hookimpl
def tangible_commands(app: Typer) -> None:
    """Add `tangible new`, `tangible parts`, `tangible legible` and `tangible schema`."""
    from tangible_core.cli.command_table import add

    add("new", "tangible_authoring.commands.new:new", "Write a pipeline file for your pictures.")
    add("parts", "tangible_authoring.commands.parts:parts", "Divide a picture into parts, which get names and heights.")
    add(
        "legible", "tangible_legibility.commands.legible:legible",
        "Check whether fingers can read a picture on paper, print, pins or a device.",
    )  # fmt: skip
    add("schema", "tangible_authoring.commands.schema:schema", "Print the JSON Schema of pipeline files.")
