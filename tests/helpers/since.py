"""`pytest --since REVISION`: the tests that import, however indirectly, what has changed since a revision."""

import subprocess
from collections.abc import Iterable
from functools import cache
from pathlib import Path

from tangible_core.provenance.closure import closure, imports
from tangible_core.provenance.versions import place

ROOT = Path(__file__).parents[2]
EVERYWHERE = ("pyproject.toml", "constraints.txt", "tests/conftest.py")
"""Files on which every test depends."""


def changed_files(revision: str) -> set[str]:
    """Return what differs from a revision, and what git does not know. Raises: CalledProcessError if there is none."""
    commands = [["diff", "--name-only", "--merge-base", revision], ["ls-files", "--others", "--exclude-standard"]]
    outputs = [
        subprocess.run(["git", *command], cwd=ROOT, check=True, capture_output=True, text=True) for command in commands
    ]
    return {line for output in outputs for line in output.stdout.splitlines()}


def affected(tests: Iterable[Path], changed: set[str]) -> set[Path]:
    """Return the test files that one of the changed files may break."""
    if changed & set(EVERYWHERE):
        return set(tests)
    return {path for path in tests if changed & depends_on(path)}


@cache
def depends_on(path: Path) -> frozenset[str]:
    """Return a test file, the conftest.py of its folders, and all of ours that they import; paths from the root."""
    files = [path, *(folder / "conftest.py" for folder in path.parents if ROOT / "tests" in folder.parents)]
    here = [file for file in files if file.is_file()]
    imported = [each for file in here for each in imports(file.read_bytes()) if each.module and not each.level]
    names = {
        name for each in imported for name in (each.module, f"{each.module}.{each.name}".strip(".")) if "*" not in name
    }
    return frozenset(str(file.relative_to(ROOT)) for file in here) | files_of(frozenset(names))


@cache
def files_of(names: frozenset[str]) -> frozenset[str]:
    """Return the files of ours among these names, and of all that they import."""
    ours = [name for name in sorted(names) if (at := place(name)) and Path(at.file).is_relative_to(ROOT)]
    return frozenset(file for module in closure(*ours).modules for file in _files(module))


def _files(module: str) -> Iterable[str]:
    """Yield the places in which a module of ours may stand."""
    path = module.replace(".", "/")
    family = module.partition(".")[0].removeprefix("tangible_")
    for home in ("", "tests/helpers/", f"plugins/{family}/"):
        yield from (f"{home}{path}.py", f"{home}{path}/__init__.py", f"{home}{path}/__init__.pyi")
