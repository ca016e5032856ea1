"""`schema`: what a pipeline file, or a file of materials, may say."""

from ..pipeline.schema import json_schema, materials_schema
from ..pipeline.schema import markdown as as_markdown
from ..runtime.standard_output import stream
from .show import print_json


def schema(markdown: bool, installed: bool) -> None:
    """Print the schema of pipeline files as JSON, or as a page."""
    found = json_schema(distribution=None if installed else "tangible-images")
    if markdown:
        print(as_markdown(found), end="", file=stream())
    else:
        print_json(found)


def schema_of_materials() -> None:
    """Print the schema of material files as JSON."""
    print_json(materials_schema())
