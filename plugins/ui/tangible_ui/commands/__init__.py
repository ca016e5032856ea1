"""The command `tangible ui`. Every start of `tangible` imports this package, so it imports next to nothing."""

from tangible_core.plugins import hookimpl


@hookimpl
def tangible_commands() -> None:
    """Add `tangible ui`."""
    from tangible_core.cli import add

    add(
        "ui", f"{__package__}.ui:ui", "See, hear and feel a surface in the browser.",
        "Begin", "tangible ui photo.jpg",
    )  # fmt: skip
