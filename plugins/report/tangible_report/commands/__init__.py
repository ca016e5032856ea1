"""The commands for materials and descriptions, imported at each start of `tangible`, so it imports next to nothing."""

from tangible_core.plugins import hookimpl


@hookimpl
def tangible_commands() -> None:
    """Add `tangible materials` and `tangible describe`."""
    from tangible_core.cli import add

    add(
        "describe", f"{__package__}.describe:describe", "Print the surface in words.",
        "Make", "tangible describe photo.jpg --lang de",
    )  # fmt: skip
    add(
        "materials", "tangible_report.commands.materials:app", "List the materials; show or draw some.",
        "Make", "tangible materials show sand",
    )  # fmt: skip
