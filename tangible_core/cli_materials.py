"""`tangible materials ...`."""

from pathlib import Path
from typing import Annotated

import typer

from .cli_options import Json
from .errors import ConfigError

materials_app = typer.Typer(name="materials")

Library = Annotated[Path | None, typer.Option(help="A YAML file of your own, added to the shipped materials.")]


@materials_app.callback(invoke_without_command=True)
def materials(context: typer.Context, library: Library = None, as_json: Json = False) -> None:
    """List the materials, with units and sources; show or draw some."""
    from .commands import materials as command

    if context.invoked_subcommand is None:
        command.materials(library, as_json)
    elif library or as_json:
        raise ConfigError(f"materials: write the options after {context.invoked_subcommand!r}")


@materials_app.command("show")
def materials_show(
    name: Annotated[str, typer.Argument(help="The material, as `tangible materials` lists it.", show_default=False)],
    library: Library = None,
    as_json: Json = False,
) -> None:
    """Say everything of one material: each value with its unit and its source, and its texture."""
    from .commands import materials as command

    command.show_one(name, library, as_json)


@materials_app.command("draw")
def materials_draw(
    names: Annotated[list[str] | None, typer.Argument(help="The materials [default: all].", show_default=False)] = None,
    out: Annotated[Path, typer.Option("--out", help="Folder for the pictures.")] = Path("out/materials"),
    library: Library = None,
    as_json: Json = False,
) -> None:
    """Draw materials, a picture each: the surface, its spectrum, the force of a stroke."""
    from .commands import materials as command

    command.draw(names or [], out, library, as_json)
