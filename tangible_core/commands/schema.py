"""`schema`: what a pipeline file may say."""

from ..schema import json_schema
from ..schema import markdown as as_markdown
from .show import print_json


def schema(markdown: bool, installed: bool) -> None:
    """Print the schema as JSON, or as a page."""
    found = json_schema(distribution=None if installed else "tangible-images")
    if markdown:
        print(as_markdown(found), end="")  # noqa: T201
    else:
        print_json(found)
