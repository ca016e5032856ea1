"""The commands that prepare and check a pipeline file. `tangible` imports them whenever it starts, so this is light."""

from tangible_core.plugins import hookimpl


@hookimpl
def tangible_commands() -> None:
    """Add the commands that write, check and describe a pipeline file."""
    from tangible_core.cli import add

    room = __package__
    add(
        "new", f"{room}.new:new", "Write a pipeline file for your pictures.",
        "Begin", "tangible new photo.jpg",
    )  # fmt: skip
    add(
        "parts", f"{room}.parts:parts", "Divide a picture into parts, which get names and heights.",
        "Make", "tangible parts photo.jpg",
    )  # fmt: skip
    add(
        "preflight", f"{room}.preflight:preflight", "Check, before a motor moves, what is safe.",
        "Feel", "tangible preflight mine.yaml --set device.use=falcon",
    )  # fmt: skip
    add(
        "schema", f"{room}.schema:schema", "Print the JSON Schema of pipeline files.",
        "The program", "tangible schema mine.yaml",
    )  # fmt: skip
