"""What is handed on: solids, pages, and whether fingers can read them."""

from . import export_paper, export_solid, legibility
from .figures import part

PARTS = {"Solids to print": export_solid, "Swell paper": export_paper, "Can fingers read it?": legibility}


def section() -> str:
    """Return the section as Markdown."""
    return "\n\n".join(f"### {heading}\n\n{part(heading, module.section)}" for heading, module in PARTS.items())
