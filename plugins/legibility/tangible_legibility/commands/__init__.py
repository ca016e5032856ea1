"""What the rules add to the program. `tangible` imports this whenever it starts, so this is light."""

from tangible_core.plugins import hookimpl


@hookimpl
def tangible_legibility() -> dict[str, str]:
    """Name the rules of tactile graphics, and parts simplified by them."""
    return {
        "judge": "tangible_legibility.legible:legibility",
        "simplify": "tangible_legibility.simplifying.simplify:simplify",
    }


@hookimpl
def tangible_commands() -> None:
    """Add `tangible legible`."""
    from tangible_core.cli import add

    add(
        "legible", f"{__package__}.legible:legible",
        "Check whether fingers can read a picture on paper, print, pins or a device.",
        "Make", "tangible legible mine.yaml --for swell",
    )  # fmt: skip
