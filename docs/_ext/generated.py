"""Pages that are written when the site is built: keys of a pipeline file, methods, time limits, results."""

import ast
import inspect
from importlib.metadata import entry_points
from itertools import pairwise
from pathlib import Path
from typing import Any

from schema_page import schema_page
from sphinx.application import Sphinx

from benchmarks import results
from tangible_core.files.writing import write_text
from tangible_core.pipeline.config.schema import json_schema
from tangible_core.servo import limits

DISTRIBUTION = "tangible-images"
FAMILIES = {
    "Depth": "tangible.depth",
    "Texture": "tangible.texture",
    "Force laws": "tangible.render",
    "Devices": "tangible.device",
    "Exporters": "tangible.export",
}
"""Headings of the page of methods, and the groups of entry points below them."""
PREFACE = """# Methods and their options

Each class is what its entry point names; its fields are its options, in Python as in YAML. The same options as tables,
with their bounds, are in [the pipeline file](yaml.md).
"""


def methods_page() -> str:
    """Return the page of the methods that this distribution brings."""
    sections = [PREFACE]
    for heading, group in FAMILIES.items():
        ours = [each for each in entry_points(group=group) if each.dist and each.dist.name == DISTRIBUTION]
        classes = "\n".join(f".. autoclass:: {each.value.replace(':', '.')}" for each in ours)
        sections.append(f"## {heading}\n\n```{{eval-rst}}\n{classes}\n```\n")
    return "\n".join(sections)


def results_page() -> str:
    """Return the page of all that was measured, the newest result of each section."""
    sections = [results.markdown(each) for each in results.newest().values()]
    head = "# Results\n\nWritten by `python -m benchmarks SECTION`. Ratios: side by side, medians."
    return "\n\n".join([head, *sections, ""])


def limits_table() -> str:
    """Return the time limits of a force loop as a table: constants, and their docstrings."""
    body = ast.parse(inspect.getsource(limits)).body
    rows = [
        f"| `{name.id}` | {ast.literal_eval(value)} | {' '.join(ast.literal_eval(text).split())} |"
        for line, after in pairwise(body)
        if isinstance(line, ast.Assign) and isinstance(after, ast.Expr)
        for name, value, text in [(line.targets[0], line.value, after.value)]
        if isinstance(name, ast.Name)
    ]
    return "\n".join(["| limit | value, `_S` in seconds | |", "|---|---|---|", *rows, ""])


def write_pages(app: Sphinx) -> None:
    """Write the pages among the others, which git does not know; a page that is as it was keeps its time."""
    pages = {
        "reference/yaml.md": schema_page(json_schema(distribution=DISTRIBUTION)),
        "reference/methods.md": methods_page(),
        "reference/limits.txt": limits_table(),
        "reference/results.md": results_page(),
    }
    for name, text in pages.items():
        path = Path(app.srcdir) / name
        if not path.exists() or path.read_text("utf-8") != text:
            path.parent.mkdir(exist_ok=True)
            write_text(path, text)


def setup(app: Sphinx) -> dict[str, Any]:
    """Write the pages before Sphinx looks for them."""
    app.connect("builder-inited", write_pages)
    return {"parallel_read_safe": True}
