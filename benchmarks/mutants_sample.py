"""Faults drawn at random from the syntax tree: how many of them do the tests notice?

Faults are made by mutmut's operators: comparisons, arithmetic, numbers, branches, conditions, arguments that are left
out. A line of code is drawn first, then a fault of that line, so that a room counts by its lines. Texts are left out,
as other tests compare messages with their translations; so is whatever only puts None in place of a value, which any
test that runs the line would notice. A fault is tried in a copy of the tree, with the tests that mirror its room.
"""

import random
import subprocess
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any, NamedTuple

from .mutants_lists import Mutant

SHIPPED = ("tangible_core", "plugins")  # folders whose Python files faults are put into
# Operators of mutmut that are left out: texts, and None in place of a value.
COARSE = {"operator_string", "operator_assignment", "operator_lambda"}
SILENT = {"log", "logging", "warnings"}  # names of objects whose calls change no result


class Fault(NamedTuple):
    """A node of a file's syntax tree, at a line, and what takes its place."""

    line: int
    node: Any
    changed: Any


def sample(root: Path, count: int, seed: int, rooms: Iterable[str] = ()) -> list[Mutant]:
    """Draw faults over all files of the rooms, or of all rooms, as mutants with the tests of their rooms.

    Raises: ValueError for a room that has no file.
    """
    chance = random.Random(seed)
    lines = [(file, line) for file in _files(root, set(rooms)) for line in _code_lines(root / file)]
    chance.shuffle(lines)
    sources: dict[str, Source] = {}
    mutants: list[Mutant] = []
    for file, line in lines:
        if len(mutants) == count:
            break
        source = sources.setdefault(file, Source(root, file))
        if mutant := source.draw(line, chance):
            mutants.append(mutant)
    return mutants


def room_name(file: str) -> str:
    """Return the room of a file: a folder of the core, or a plugin's family.

    >>> room_name("tangible_core/scene/formats/tiff.py"), room_name("plugins/study/tangible_study/design.py")
    ('scene', 'study')
    >>> room_name("tangible_core/errors.py")
    'core'
    """
    parts = Path(file).parts
    return parts[1] if len(parts) > 2 else "core"


class Source:
    """A file with all its faults."""

    def __init__(self, root: Path, file: str) -> None:
        """Parse the file."""
        import libcst as cst
        from libcst.metadata import MetadataWrapper, PositionProvider

        self._root, self._file, self._text = root, file, (root / file).read_text("utf-8")
        wrapper = MetadataWrapper(cst.parse_module(self._text), unsafe_skip_copy=True)
        self._module, places = wrapper.module, wrapper.resolve(PositionProvider)
        self._by_line: dict[int, list[Fault]] = {}
        for node, changed in _changes(self._module):
            line = places[node].start.line
            self._by_line.setdefault(line, []).append(Fault(line, node, changed))

    def draw(self, line: int, chance: random.Random) -> Mutant | None:
        """Return one of the faults of a line that is Python; None if it has none."""
        candidates = self._by_line.get(line, [])
        for fault in chance.sample(candidates, len(candidates)):
            text = self._module.deep_replace(fault.node, fault.changed).code
            if text != self._text and _compiles(text):
                return self._mutant(fault, text)
        return None

    def _mutant(self, fault: Fault, text: str) -> Mutant:
        before, after = (" ".join(self._module.code_for_node(node).split()) for node in (fault.node, fault.changed))
        return Mutant(
            place=f"{self._file}:{fault.line}",
            room=room_name(self._file),
            name=f"`{before[:90]}` -> `{after[:90]}`",
            file=self._file,
            old=self._text,
            new=text,
            tests=_tests(self._root, self._file),
        )


def _changes(node: Any) -> Iterator[tuple[Any, Any]]:
    import libcst as cst
    import libcst.matchers as m
    from mutmut.mutation.mutators import mutation_operators

    silent = m.Call(func=m.Attribute(value=m.Name(m.MatchIfTrue(SILENT.__contains__))))
    if isinstance(node, cst.Annotation | cst.Decorator | cst.Import | cst.ImportFrom) or m.matches(node, silent):
        return
    for kind, operator in mutation_operators:
        if isinstance(node, kind) and operator.__name__ not in COARSE:
            yield from ((node, changed) for changed in operator(node) if not _is_coarse(node, changed))
    for child in node.children:
        yield from _changes(child)


def _is_coarse(node: Any, changed: Any) -> bool:
    """Return whether an argument became None, or is left out although others follow it: such a call mostly raises."""
    import libcst as cst

    if not (isinstance(node, cst.Call) and isinstance(changed, cst.Call) and node.func is changed.func):
        return False
    if len(node.args) == len(changed.args):
        return True
    gone = next(argument for argument in node.args if argument not in changed.args)
    return gone.keyword is None and gone is not node.args[-1]


def _compiles(text: str) -> bool:
    try:
        compile(text, "", "exec")
    except SyntaxError:
        return False
    return True


def _files(root: Path, rooms: set[str]) -> list[str]:
    command = ["git", "ls-files", "-z", *(f"{folder}/*.py" for folder in SHIPPED)]
    listed = subprocess.run(command, cwd=root, check=True, capture_output=True).stdout.decode()
    files = sorted(file for file in listed.split("\0") if file)
    known = {room_name(file) for file in files}
    if unknown := rooms - known:
        raise ValueError(f"no room is named {', '.join(sorted(unknown))}; rooms are {', '.join(sorted(known))}")
    return [file for file in files if not rooms or room_name(file) in rooms]


def _code_lines(path: Path) -> Iterator[int]:
    for number, line in enumerate(path.read_text("utf-8").splitlines(), 1):
        if line.strip() and not line.lstrip().startswith(("#", '"""', "import ", "from ")):
            yield number


def _tests(root: Path, file: str) -> tuple[str, ...]:
    """Return the folder of tests that mirrors a file's room; of the page, what needs no browser."""
    parent = Path("tests/plugins" if file.startswith("plugins/") else "tests/core")
    folder = Path("tests/ui") if room_name(file) == "ui" else parent / room_name(file)
    if not (root / folder).is_dir():
        return (str(parent),)
    browser = folder / "browser"
    if not (root / browser).is_dir():
        return (str(folder),)
    return tuple(
        sorted(
            str(folder / path.name) for path in (root / folder).iterdir() if path.is_dir() and path.name[0] not in "_b"
        )
    )
