"""`new`: write a starter pipeline file."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from tangible_core.cli import is_quiet, show
from tangible_core.errors import OutputError

from .schema import write_beside


def new(
    pictures: Annotated[
        list[Path],
        typer.Argument(
            metavar="FILE...", help="A picture, left and right, a map of heights, or a video.", show_default=False
        ),
    ],
    out: Annotated[Path | None, typer.Option("--out", help="The file to write [default: NAME.yaml].")] = None,
    force: Annotated[bool, typer.Option("--force", help="Overwrite an existing file.")] = False,
) -> None:
    """Write a pipeline file for your pictures.

    Its values suit these pictures, and comments say what they mean. Editors complete and check it by the schema that
    is written next to it.
    """
    from tangible_core.files import write_text
    from tangible_core.pipeline import are_pictures, not_pictures
    from tangible_core.pipeline.config import json_schema
    from tangible_core.pipeline.output import default_name
    from tangible_core.pipeline.starter import starter

    if not are_pictures(pictures):
        raise not_pictures(pictures)
    file = out or Path(f"{default_name(*pictures)}.yaml")
    if file.exists() and not force:
        raise OutputError(f"{file}: is there already; --out FILE writes another one, --force writes over it")
    write_text(file, starter(pictures, file).text)
    schema = write_beside(file, json_schema(), "tangible")
    if is_quiet():
        return
    show.plain(f"written: {file}\nwritten: {schema}\n\nNext:")
    show.plain(f"  tangible ui {file}         shows it on a page in the browser, to be felt with the mouse")
    show.plain(f"  tangible run {file}        makes what can be felt, and draws it")
    show.plain(f"  tangible preflight {file}  says whether it is safe on its device")
