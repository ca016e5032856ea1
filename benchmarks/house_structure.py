"""The structure of the source: sizes, rooms, floors and arrows, and the words, with the bounds that the house keeps."""

import re
import subprocess
from collections import Counter
from functools import cache
from pathlib import Path

import grimp

from tangible_core import Pipeline

from .house_words import ROOT, count_words, share, shipped

CORE = "tangible_core"
IMPORT_OF_CORE = re.compile(rf"^\s*(?:from|import) ({CORE}[\w.]*)", re.MULTILINE)
PLUGINS_IMPORT = 40
"""Modules of the core that plugins import from, at most: its rooms, whose stubs list the names."""
LARGEST_FOLDER = 10
"""Files next to `__init__.py` that a folder holds at most, as a stranger looks through them at a glance."""


def structure_rows() -> list[str]:
    """Return the table of sizes and words as Markdown."""
    files = [path for folder in shipped() for path in folder.rglob("*.py") if "node_modules" not in path.parts]
    lines = {path: len(path.read_text(encoding="utf-8").splitlines()) for path in files}
    rooms, floors, arrows = core_graph()
    words = count_words(shipped())
    members = [name for name in vars(Pipeline) if not name.startswith("_")]
    longest = max(lines.values())
    full = sum(count > LARGEST_FOLDER for count in source_folders().values())
    return [
        "| measure | figure | bound | |",
        "|---|---|---|---|",
        *(
            f"| {what} | {figure} | <= {bound} | {'met' if figure <= bound else 'missed'} |"
            for what, figure, bound in (
                ("all Python that is shipped: lines", sum(lines.values()), 78_000),
                ("tests: lines", tracked_lines("tests/*.py"), 52_000),
                ("lists of faults: lines", tracked_lines("benchmarks/mutations/*.yaml"), 3_500),
                ("benchmarks: lines", tracked_lines("benchmarks/*.py"), 8_500),
                ("core: rooms", rooms, 22),
                ("core: floors", floors, 9),
                ("core: arrows", arrows, 105),
                ("modules of the core that plugins import", len(modules_for_plugins()), PLUGINS_IMPORT),
                (f"folders with more than {LARGEST_FOLDER} files", full, 10),
                ("longest file: lines", longest, 300),
                ("public members of Pipeline", len(members), 18),
                ("bare participles, % of functions", round(share(words.participles, words.functions), 1), 1),
                ("docstrings that open with a function word, %", round(share(words.openers, words.docstrings), 1), 5),
            )
        ),
    ]


def tracked_lines(pattern: str) -> int:
    """Return the lines of the files that git knows by this pattern."""
    listed = subprocess.run(["git", "ls-files", "-z", pattern], cwd=ROOT, capture_output=True, text=True, check=True)
    paths = [ROOT / name for name in listed.stdout.split("\0") if name]
    return sum(len(path.read_text(encoding="utf-8").splitlines()) for path in paths if path.exists())


def source_folders() -> Counter[Path]:
    """Return the number of source files of each folder, Python's and the page's, without `__init__.py`."""
    listed = subprocess.run(
        ["git", "ls-files", "*.py", "*.ts"], cwd=ROOT, capture_output=True, text=True, check=True
    ).stdout.split()
    paths = [Path(each) for each in listed if each.startswith((CORE, "plugins")) and "/test/" not in each]
    return Counter(path.parent for path in paths if path.name != "__init__.py")


def modules_for_plugins() -> list[str]:
    """Return the modules of the core that plugins import from."""
    texts = [path.read_text(encoding="utf-8") for path in ROOT.glob("plugins/*/tangible_*/**/*.py")]
    return sorted({module for text in texts for module in IMPORT_OF_CORE.findall(text)})


def core_graph() -> tuple[int, int, int]:
    """Return the rooms of the core (its folders and top files), the floors that they stand on, and the arrows."""
    graph = grimp.build_graph(CORE)
    rooms = sorted(graph.find_children(CORE))
    for room in rooms:
        graph.squash_module(room)
    below = {room: graph.find_modules_directly_imported_by(room) & set(rooms) - {room} for room in rooms}

    @cache
    def floor(room: str) -> int:
        return 1 + max((floor(each) for each in below[room]), default=0)

    return len(rooms) + 1, max(map(floor, rooms)), sum(map(len, below.values()))
