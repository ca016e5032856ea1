"""The command for many scenes. It is imported at each start of `tangible`, so it imports next to nothing."""

from tangible_core.plugins import hookimpl


@hookimpl
def tangible_commands() -> None:
    """Add `tangible batch`."""
    from tangible_core.cli import add

    add(
        "batch", "tangible_batch.commands.batch:batch",
        "Run many pictures, or many settings, through one pipeline file.",
        "Make", "tangible batch mine.yaml --over pictures/*.jpg",
    )  # fmt: skip
