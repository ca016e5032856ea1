"""The lists of mutants, benchmarks/mutations/*.yaml, and whether each still fits the code."""

import ast
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from pydantic import BaseModel, ConfigDict, ValidationError
from ruamel.yaml import YAML
from ruamel.yaml.comments import CommentedSeq
from ruamel.yaml.error import YAMLError


class Mutant(BaseModel):
    """One fault that the tests must notice."""

    model_config = ConfigDict(frozen=True, extra="forbid", use_attribute_docstrings=True)

    place: str
    """Where it stands: list and line."""
    room: str
    """The name of its list."""
    name: str
    """What goes wrong, in words."""
    file: str
    """The file that is changed, from the root of the tree."""
    old: str
    """Stands exactly once in the file,"""
    new: str
    """and this in its stead."""
    tests: tuple[str, ...] = ()
    """Files or node ids of pytest, of which one has to fail."""
    equivalent: str = ""
    """Why no test can notice it, if none can."""


class StaleError(Exception):
    """A list does not fit the code any more; a line for each entry, with its place."""


def mutants(root: Path) -> list[Mutant]:
    """All lists of a tree. Raises: StaleError if one cannot be read or does not fit."""
    found: list[Mutant] = []
    wrong: list[str] = []
    for path in sorted(root.glob("benchmarks/mutations/*.yaml")):
        try:
            found += _read(path)
        except (YAMLError, ValidationError, TypeError) as error:
            wrong.append(f"{path.name}: {error}")
    for mutant in found:
        wrong += (f"{mutant.place}: {mutant.name}: {misfit}" for misfit in _misfits(root, mutant))
    names = [(mutant.room, mutant.name) for mutant in found]
    wrong += (f"{room}.yaml: {name}: stands twice" for room, name in set(names) if names.count((room, name)) > 1)
    if wrong:
        raise StaleError("\n".join(wrong))
    return found


def mutated(root: Path, mutant: Mutant) -> str:
    """Return the text of its file with the fault in it."""
    return (root / mutant.file).read_text(encoding="utf-8").replace(mutant.old, mutant.new)


def _read(path: Path) -> Iterator[Mutant]:
    entries: Any = YAML(typ="rt").load(path)  # which keeps the lines
    if type(entries) is not CommentedSeq:
        raise TypeError("is no list")
    for i, entry in enumerate(entries):
        yield Mutant(place=f"{path.name}:{entries.lc.item(i)[0] + 1}", room=path.stem, **entry)


def _misfits(root: Path, mutant: Mutant) -> Iterator[str]:
    if not (root / mutant.file).is_file():
        yield f"there is no {mutant.file}"
    elif (count := (root / mutant.file).read_text(encoding="utf-8").count(mutant.old)) != 1:
        yield f"`old` stands {count} times in {mutant.file}, not once"
    elif mutant.old == mutant.new:
        yield "`new` is `old`"
    elif mutant.file.endswith(".py") and not _is_python(mutated(root, mutant)):
        yield f"{mutant.file} is not Python with it"
    if not mutant.tests and not mutant.equivalent:
        yield "names no tests"
    yield from (f"there is no {test}" for test in mutant.tests if not _is_test(root, test))


def _is_python(text: str) -> bool:
    try:
        ast.parse(text)
    except SyntaxError:
        return False
    return True


def _is_test(root: Path, node: str) -> bool:
    file, *names = node.partition("[")[0].split("::")
    if not (root / file).is_file():
        return (root / file).is_dir() and not names
    text = (root / file).read_text(encoding="utf-8")
    return all(re.search(rf"^\s*((async )?def|class) {name}\b|^{name} =", text, re.MULTILINE) for name in names)
