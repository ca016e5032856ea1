"""Measure, and write benchmarks/RESULTS.md: `python -m benchmarks [section ...]`; other sections stay as they are."""

import os
import platform
import re
import sys
from datetime import date
from importlib import import_module
from importlib.metadata import version
from pathlib import Path

from tangible_bench.measuring.machine import machine

from .figures import MissedError

RESULTS = Path(__file__).with_name("RESULTS.md")
SECTIONS = {
    "house": "The house itself",
    "depth": "Depth",
    "texture": "Texture",
    "regions": "Regions that people draw",
    "photos": "Photographs",
    "relief": "The relief of depth",
    "parts": "Parts of a picture",
    "export": "Handing it on",
    "render": "Force laws",
    "methods": "Every method with its defaults",
    "servo": "The force loop",
    "servo_late": "How late the force loop is",
    "servo_faults": "Faults around the force loop",
    "batch": "Many scenes",
    "video": "Moving pictures",
    "record": "Recordings",
    "devices": "Devices",
    "ui": "The page",
    "page_to_send": "The page to send",
    "by_ear": "By ear",
    "study": "Studies with people",
    "tests": "The test run",
    "mutants": "Faults that the tests notice",
}
VERSIONS = ("tangible-images", "numpy", "opencv-contrib-python-headless", "scikit-image", "numba", "pydantic", "typer")
HEAD = """# Results

Written by `python -m benchmarks` (`python -m benchmarks SECTION` for one part). Ratios: side by side, medians.
"""


def main(names: list[str]) -> None:
    """Measure the named sections, or all."""
    if unknown := set(names) - set(SECTIONS):
        sys.exit(f"no section {', '.join(sorted(unknown))}; there are {', '.join(SECTIONS)}")
    os.environ.pop("PYTHONDONTWRITEBYTECODE", None)  # what is installed has its bytecode, and need not be compiled anew
    missed = False
    for name in names or SECTIONS:
        print(f"measuring {name} ...", file=sys.stderr)
        try:
            section = import_module(f"benchmarks.{name}").section()
        except MissedError as error:
            section, missed = str(error), True
        keep(name, section)
    print(RESULTS)
    sys.exit(missed)


def keep(name: str, section: str) -> None:
    """Write a section; the others stay."""
    sections = kept() | {SECTIONS[name]: f"{_machine()}\n\n{section}\n"}
    text = "\n".join(f"## {title}\n\n{sections[title]}" for title in SECTIONS.values() if title in sections)
    RESULTS.write_text(f"{HEAD}\n{text}", encoding="utf-8")


def kept() -> dict[str, str]:
    """Return the sections that are there, by title."""
    text = RESULTS.read_text(encoding="utf-8") if RESULTS.exists() else ""
    parts = re.split(r"^## (.+)\n\n", text, flags=re.MULTILINE)
    return {title: body.rstrip("\n") + "\n" for title, body in zip(parts[1::2], parts[2::2], strict=True)}


def _machine() -> str:
    versions = ", ".join(f"{name} {version(name)}" for name in VERSIONS)
    return (
        f"{date.today()}, {machine()['processor']}, {os.cpu_count()} cores, {platform.system()} {platform.machine()}, "
        f"Python {platform.python_version()}, {versions}."
    )


if __name__ == "__main__":
    main(sys.argv[1:])
