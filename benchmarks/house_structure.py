"""The structure of the source: sizes, rooms, floors and arrows, and the words, with the bounds that the house keeps."""

import re
import subprocess
from collections import Counter
from functools import cache
from pathlib import Path

import grimp

from tangible_core import Pipeline

from .house_things import THINGS
from .house_words import ROOT, count_words, shipped

CORE = "tangible_core"
IMPORT_OF_CORE = re.compile(rf"^\s*(?:from|import) ({CORE}[\w.]*)", re.MULTILINE)
# Modules of the core that plugins import from, at most: its rooms, whose stubs list the names.
PLUGINS_IMPORT = 40
NAMES = {"functions": 1, "locals": 1.5, "parameters": 1.5, "attributes": 3}
"""The kinds of names, and the share of each that may be a bare participle, in per cent."""
# Files next to `__init__.py` that a folder holds at most, as a stranger looks through them at a glance.
LARGEST_FOLDER = 10


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
                ("all Python that is shipped: lines", sum(lines.values()), 80_000),
                ("tests: lines", tracked_lines("tests/*.py"), 62_000),
                ("lists of faults: lines", tracked_lines("benchmarks/mutations/*.yaml"), 3_500),
                ("benchmarks: lines", tracked_lines("benchmarks/*.py"), 9_800),
                ("TypeScript that is shipped: lines", shipped_typescript(), 23_000),
                *((f"files that a new {thing} touches", len(files), 3) for thing, files in THINGS.items()),
                ("houses: floors", house_floors(), 6),
                ("houses that stand on the page", len(houses_on("tangible_ui")), 0),
                ("mechanisms of translation", len(translation_mechanisms()), 2),
                ("core: rooms", rooms, 22),
                ("core: floors", floors, 9),
                ("core: arrows", arrows, 105),
                ("modules of the core that plugins import", len(modules_for_plugins()), PLUGINS_IMPORT),
                (f"folders with more than {LARGEST_FOLDER} files", full, 10),
                ("longest file: lines", longest, 300),
                ("public members of Pipeline", len(members), 20),
                *(
                    (f"bare participles, % of {kind}", round(words.share(kind), 1), bound)
                    for kind, bound in NAMES.items()
                ),
                ("`each`, % of loop variables", round(words.share("loop variables"), 1), 2),
                ("functions `..._of`", len(words.places["functions x_of"]), 10),
                ("constants `MOST_`, `LEAST_`", len(words.places["constants"]), 0),
                ("docstrings that open with a function word, %", round(words.share("docstrings"), 1), 5),
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


def shipped_typescript() -> int:
    """Return the lines of TypeScript that is shipped, without its tests."""
    return tracked_lines("plugins/*.ts") - tracked_lines("plugins/*/test/*.ts")


def house_floors() -> int:
    """Return the floors on which the houses stand by their imports: the core and the packages of `plugins`."""
    houses = [CORE, *(path.name for path in ROOT.glob("plugins/*/tangible_*"))]
    return tallest(grimp.build_graph(*houses), houses)


def houses_on(house: str) -> list[str]:
    """Return the other packages of `plugins` that import a house."""
    imported = re.compile(rf"^\s*(?:from|import) {house}\b", re.MULTILINE)
    packages = [path for path in ROOT.glob("plugins/*/tangible_*") if path.name != house]
    return [
        path.name
        for path in packages
        if any(imported.search(each.read_text(encoding="utf-8")) for each in path.rglob("*.py"))
    ]


def translation_mechanisms() -> list[str]:
    """Return what texts are translated by: catalogues, the page's tables, and each other table of words."""
    files = [path for folder in shipped() for name in ("words.py", "words/de.json") for path in folder.rglob(name)]
    tables = [file for file in files if file.stem == "de" or '"de"' in file.read_text(encoding="utf-8")]
    kinds = {"catalogues": "tangible_core/translation/*.po", "tables of the page": "plugins/**/src/words/words.ts"}
    return [*(kind for kind, pattern in kinds.items() if any(ROOT.glob(pattern))), *map(str, tables)]


def core_graph() -> tuple[int, int, int]:
    """Return the rooms of the core (its folders and top files), the floors that they stand on, and the arrows."""
    graph = grimp.build_graph(CORE)
    rooms = sorted(graph.find_children(CORE))
    floors = tallest(graph, rooms)
    return len(rooms) + 1, floors, sum(len(below) for below in arrows(graph, rooms).values())


def arrows(graph: grimp.ImportGraph, rooms: list[str]) -> dict[str, set[str]]:
    """Return the rooms that each room of a graph imports; the graph's rooms are squashed."""
    return {room: graph.find_modules_directly_imported_by(room) & set(rooms) - {room} for room in rooms}


def tallest(graph: grimp.ImportGraph, rooms: list[str]) -> int:
    """Squash the rooms of a graph; return the number of floors on which they stand."""
    for room in rooms:
        graph.squash_module(room)
    below = arrows(graph, rooms)

    @cache
    def floor(room: str) -> int:
        return 1 + max((floor(each) for each in below[room]), default=0)

    return max(map(floor, rooms))
