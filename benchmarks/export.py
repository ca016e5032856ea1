"""What is handed on: solids, pages, pins, and whether fingers can read them."""

from importlib import import_module
from importlib.util import find_spec

from .figures import MissedError, part

PARTS = {
    "export_solid": "Solids to print",
    "export_paper": "Swell paper and pins",
    "legibility": "Can fingers read it?",
}
"""Modules of this package, each with a `section` of its own, and their headings."""


def section() -> str:
    """Return the section as Markdown. Raises: MissedError, with it, if a part misses a bound."""
    texts, missed = list[str](), False
    for name, heading in PARTS.items():
        if find_spec(f"benchmarks.{name}") is None:
            continue
        try:
            text = part(heading, import_module(f"benchmarks.{name}").section)
        except MissedError as error:
            text, missed = str(error), True
        texts.append(f"### {heading}\n\n{text}")
    found = "\n\n".join(texts)
    if missed:
        raise MissedError(found)
    return found
