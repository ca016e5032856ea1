"""The commands that devices add to `tangible`; imported at every start of it, so that this imports next to nothing."""

from tangible_core.plugins import hookimpl


@hookimpl
def tangible_commands() -> None:
    """Add `tangible devices` and `tangible pointer`."""
    from tangible_core.cli import add

    add(
        "devices", f"{__package__}.devices:app", "List devices; examine, home or calibrate one.",
        "Feel", "tangible devices doctor falcon",
    )  # fmt: skip
    add(
        "pointer", f"{__package__}.pointer:pointer", "Move a `pointer` device by hand and see the forces.",
        "Feel", "tangible pointer mine.yaml",
    )  # fmt: skip
