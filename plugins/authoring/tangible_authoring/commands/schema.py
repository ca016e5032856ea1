"""The command `schema`: the schema of pipeline files and of material files."""

from pathlib import Path
from typing import Annotated, Any

import typer

LINE = "# yaml-language-server: $schema="  # by which an editor finds the schema


def schema(
    file: Annotated[
        Path | None,
        typer.Argument(metavar="FILE", help="A pipeline file, beside which the schema is written.", show_default=False),
    ] = None,
    installed: Annotated[bool, typer.Option("--installed", help="Include the methods of other plugins.")] = False,
    materials: Annotated[bool, typer.Option("--materials", help="Schema of material files instead.")] = False,
) -> None:
    """Print the JSON Schema of pipeline files, or write it beside a file.

    Editors complete and check files by it. A file gets the line by which they find it.
    """
    from tangible_core.cli import plain, print_json
    from tangible_core.pipeline.config import json_schema, materials_schema

    schema = materials_schema() if materials else json_schema(distribution=None if installed else "tangible-images")
    if file is None:
        print_json(schema)
    else:
        plain(f"written: {write_beside(file, schema, 'materials' if materials else 'tangible')}")


def write_beside(file: Path, schema: dict[str, Any], name: str) -> Path:
    """Write a schema for editors next to a file, and name it in the file's first line unless it is named there."""
    from tangible_core.files import as_json, write_text
    from tangible_core.files.yaml import read_text

    from ..editor_schema import for_editors

    text = read_text(file)
    path = file.with_name(f"{name}.schema.json")
    write_text(path, f"{as_json(for_editors(schema))}\n")
    if LINE not in text:
        write_text(file, f"{LINE}{path.name}\n{text}")
    return path
