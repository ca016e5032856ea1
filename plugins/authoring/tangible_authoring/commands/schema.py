"""The command `schema`: the schema of pipeline files and of material files."""

from typing import Annotated

import typer


def schema(
    markdown: Annotated[bool, typer.Option("--markdown", help="A reference page instead of JSON Schema.")] = False,
    installed: Annotated[bool, typer.Option("--installed", help="Include the methods of other plugins.")] = False,
    materials: Annotated[bool, typer.Option("--materials", help="Schema of material files instead.")] = False,
) -> None:
    """Print the JSON Schema of pipeline files.

    Editors complete and check files by it.
    """
    from tangible_core.cli.show import print_json
    from tangible_core.pipeline.config.schema import json_schema, materials_schema
    from tangible_core.runtime.standard_output import stream

    from ..schema_page import schema_page

    if materials:
        print_json(materials_schema())
        return
    schema = json_schema(distribution=None if installed else "tangible-images")
    if markdown:
        print(schema_page(schema), end="", file=stream())
    else:
        print_json(schema)
