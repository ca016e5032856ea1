"""The command that compares methods. Imported whenever `tangible` starts, so this room imports next to nothing."""

from tangible_core.plugins import hookimpl


@hookimpl
def tangible_commands() -> None:
    """Add `tangible compare`."""
    from tangible_core.cli import add

    add(
        "compare", "tangible_bench.commands.compare:compare", "Compare methods by time, memory and error.",
        "Compare", "tangible compare semi-global zncc",
    )  # fmt: skip
