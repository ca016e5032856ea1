"""What the networks add to the program. `tangible` imports this whenever it starts, so this is light."""

from tangible_core.plugins import hookimpl


@hookimpl
def tangible_networks() -> dict[str, str]:
    """Name what looks at a photograph, what reads texts, and what tells which networks are here."""
    return {
        "look": "tangible_networks.seeing:look", "read": "tangible_networks.reading:read_texts",
        "identity": "tangible_networks.store:identity_here",
    }  # fmt: skip


@hookimpl
def tangible_commands() -> None:
    """Add `tangible networks`."""
    from tangible_core.cli import add

    add(
        "networks", f"{__package__}.networks:app", "List the networks that the program can use; add or remove them.",
        "The program", "tangible networks",
    )  # fmt: skip
