"""`tangible ui`: see, hear and feel a surface in the browser."""

from pathlib import Path
from typing import Annotated

import typer

HELP = "A pipeline file, a picture, left and right, or a recording; without one, the page begins with a choice."


def ui(
    files: Annotated[list[Path] | None, typer.Argument(metavar="FILE...", help=HELP, show_default=False)] = None,
    sets: Annotated[list[str] | None, typer.Option("--set", metavar="KEY.KEY=VALUE", help="Change one value.")] = None,
    port: Annotated[
        int | None, typer.Option(min=0, max=65535, help="Port of this machine; by default, and for 0, a free one.")
    ] = None,
    browser: Annotated[bool, typer.Option(help="Open the page in the browser.")] = True,
) -> None:
    """See, hear and feel a surface in the browser.

    The page is served to this machine alone; its address holds a key that changes with every start, except after a
    program that was killed: its pages go on. Ctrl-C ends it.
    """
    _check_files(files or [])
    from tangible_web.address import Address

    from ..prestart import prestart_worker
    from ..user_data import user_folder

    listening = Address.again(user_folder("address") / "ui") if port is None else Address.of(port)
    with listening as address, prestart_worker():
        address.announce(browser)
        from ..serving.serve import serve

        serve(files or [], sets or [], address)


def _check_files(files: list[Path]) -> None:
    """Refuse a file that does not exist before a page is opened for it. Raises: PictureError, with a similar name."""
    for file in files:
        if not file.exists() and file.parts[:1] != ("builtin",):
            from tangible_core.scene.formats import absent

            raise absent(file, "file")
