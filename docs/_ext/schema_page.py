"""The JSON Schema of a pipeline file as a page to read: every key, method and option."""

from collections.abc import Iterable, Iterator, Mapping
from itertools import groupby
from typing import Any

from tangible_core.data import default_in_code, name_of_block, options_in, values_in_code
from tangible_core.pipeline.config import KEYS, Key

PREFACE = (
    "Generated from the classes themselves. `tangible schema FILE` writes the same beside a file as JSON Schema, by "
    "which your editor completes and checks it.\n\n"
    "Relative paths are relative to the file itself. A number whose name ends with a unit may be written with another "
    "one of its kind, such as `6 mm`, `0.8 N/mm`, `250 ms`; without a unit, it is in that of the name."
)


def schema_page(schema: Mapping[str, Any], keys: Mapping[str, Key] = KEYS) -> str:
    """Write the schema of a pipeline file as a reference page."""
    properties, blocks = schema["properties"], schema["$defs"]
    lines = ["# The pipeline file", "", PREFACE, ""]
    for plain, names in groupby(properties, lambda name: not _forms(properties[name])):
        if plain:
            words = {name: properties[name] for name in names}
            lines += [f"## {', '.join(words)}", "", *_table({"properties": words}, blocks)]
            continue
        for name in names:
            about = f"{properties[name]['description']} {keys[name].note}".strip()
            lines += [f"## {name}", "", " ".join(about.split()), "", *_tables(_forms(properties[name]), blocks)]
    return "\n".join(lines).rstrip() + "\n"


def _forms(node: Mapping[str, Any]) -> list[dict[str, Any]]:
    """Find the blocks with options that a key may be, through lists and maps from numbers."""
    if "properties" in node or "$ref" in node:
        return [dict(node)]
    below = [*node.get("anyOf", ()), *node.get("patternProperties", {}).values()]
    below += [node["items"]] if "items" in node else []
    return [form for node_below in below for form in _forms(node_below)]


def _tables(forms: Iterable[dict[str, Any]], blocks: Mapping[str, Any]) -> Iterator[str]:
    for index, form in enumerate(forms):
        if use := form.get("properties", {}).get("use", {}).get("const"):
            yield from (f"### {use}", "", form.get("description", "").split("\n")[0], "")
        elif index:
            yield from (f"Or {_first_line(form, blocks)}", "")
        yield from _table(form, blocks)


def _first_line(form: Mapping[str, Any], blocks: Mapping[str, Any]) -> str:
    about = blocks[name_of_block(form)]["description"] if "$ref" in form else form["description"]
    return f"{about[0].lower()}{about[1:].partition(chr(10))[0]}"


def _table(form: Mapping[str, Any], blocks: Mapping[str, Any]) -> list[str]:
    form = blocks[name_of_block(form)] if "$ref" in form else form
    rows = [
        f"| `{name}` | {values_in_code(option)} | {default_in_code(option)} | {_cell(option)} |"
        for name, option in options_in(form, blocks)
    ]
    return ["| key | values | default | meaning |", "|---|---|---|---|", *rows, ""] if rows else ["No options.", ""]


def _cell(option: Mapping[str, Any]) -> str:
    return " ".join(option.get("description", "").split()).replace("|", "\\|")
