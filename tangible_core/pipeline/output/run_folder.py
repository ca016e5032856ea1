"""The folder of a run: what one run made, all of it or marked as torn, and nothing of an earlier one.

A manifest names the files that a run wrote, with a digest of each, so that the next one takes these away and no others.
What says what the products are (the configuration, the outcomes) goes first and comes last: a run that was killed
leaves products that nothing describes wrongly, and a manifest that says so.
"""

import json
import os
import tempfile
from collections.abc import Callable, Generator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from itertools import count
from pathlib import Path
from typing import Any, cast

from ...data.products import PRODUCTS
from ...errors import OutputError
from ...files.reading import MOST_TEXT_BYTES, content_digest, read_bytes
from ...files.writing import write_text

MANIFEST = "manifest.json"
CONFIG, NO_CONFIG, OUTCOMES = "config.yaml", "config.txt", "outcomes.json"
CLAIMS = (CONFIG, NO_CONFIG, OUTCOMES)
"""What says what the other files are."""
RECORDING, SHEET = "recording.npz", "sheet"
GUESSED = "parts-guessed.yaml"
"""What was guessed of parts, to correct."""
SHEETS = tuple(f"{SHEET}.{drawn_as}" for drawn_as in ("png", "svg", "pdf"))
NAMES = (*CLAIMS, *(f"{product}.npz" for product in PRODUCTS), RECORDING, GUESSED, *SHEETS)
"""What a run may write."""


@dataclass(frozen=True)
class Manifest:
    """What a run wrote into a folder."""

    source: str = ""
    """The pipeline file, relative to the folder where it can be; empty for one that was made in Python."""
    files: Mapping[str, str] = field(default_factory=dict[str, str])
    """Digests of the contents by name."""
    complete: bool = True
    """False while a run writes, and for ever if it was killed meanwhile."""

    def write(self, folder: Path) -> None:
        """Raises: OutputError."""
        plain = {"source": self.source, "complete": self.complete, "files": dict(self.files)}
        write_text(folder / MANIFEST, json.dumps(plain, indent=2) + "\n")


def read_manifest(folder: Path) -> Manifest | None:
    """The manifest of a folder; None where there is none that can be read."""
    try:
        plain = json.loads(read_bytes(folder / MANIFEST, MOST_TEXT_BYTES))
        files = cast("dict[Any, Any]", plain["files"])
        own = {name: digest for name, digest in files.items() if isinstance(digest, str) and Path(name).name == name}
        return Manifest(str(plain["source"]), own, plain["complete"] is True)
    except (OSError, ValueError, TypeError, KeyError, AttributeError, RecursionError):
        return None


def default_folder(source: Path, parent: Path = Path("out")) -> Path:
    """`parent`/NAME for the results of this pipeline file, or NAME-2, NAME-3 where other files lie there."""
    name = default_name(source)
    numbered = (parent / (name if number == 1 else f"{name}-{number}") for number in count(1))
    return next(folder for folder in numbered if _is_free_for(folder, source))


def default_name(source: Path) -> str:
    """That of the pipeline file, or of the folder of the run whose completed configuration it is."""
    ran = source.name == CONFIG and (source.parent / OUTCOMES).exists()
    return source.resolve().parent.name if ran else source.stem


def _is_free_for(folder: Path, source: Path) -> bool:
    found = read_manifest(folder)
    if found is None:
        return not any((folder / name).exists() for name in NAMES)
    return found.source == relative_source(source, folder)


def relative_source(source: Path | None, folder: Path) -> str:
    """A pipeline file as its manifest names it: the same when all of a project is moved."""
    if source is None:
        return ""
    try:
        return Path(os.path.relpath(source.resolve(), folder.resolve())).as_posix()
    except ValueError:  # on another drive
        return str(source.resolve())


def check_folder(folder: Path, source: Path | None) -> None:
    """Raises: OutputError if the folder cannot be written, or holds a file that a run would write and no run wrote."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            pass
    except OSError as error:
        raise OutputError(f"{folder}: cannot be written: {error.strerror}; choose another folder") from error
    expected = {folder / name for name in _own(folder)}
    if source is not None and source.resolve() == (folder / CONFIG).resolve():  # edited, and run in its place
        expected.add(folder / CONFIG)
    for path in (folder / name for name in NAMES):
        if path not in expected and path.exists():
            raise OutputError(f"{path}: no run left it so, and this one would overwrite it; choose another folder")


def _own(folder: Path) -> dict[str, str]:
    """Files that are as an earlier run left them, with their digests."""
    manifest, there = read_manifest(folder), {name: content_digest(folder / name) for name in NAMES}
    if manifest is None:
        own = there if _is_of_before_manifests(folder) else {}
    elif manifest.complete:
        own = {name: digest for name, digest in manifest.files.items() if content_digest(folder / name) == digest}
    else:  # nobody else's were there when that run began
        own = {**manifest.files, **there}
    return {name: digest for name, digest in own.items() if digest}


def _is_of_before_manifests(folder: Path) -> bool:
    """Whether a run wrote this folder by a version that wrote no manifest: its outcomes tell it."""
    if (folder / MANIFEST).exists():  # damaged: what was changed since can no longer be told
        return False
    try:
        return isinstance(json.loads(read_bytes(folder / OUTCOMES))["outcomes"], list)
    except (OSError, ValueError, TypeError, KeyError, RecursionError):
        return False


@contextmanager
def rewritten(folder: Path, source: Path | None) -> Generator[Callable[[str], Path]]:
    """For a block that writes what a run made: what an earlier one left is gone, and only this is there in the end.

    Yields: where a file of this name belongs. Raises: OutputError if something cannot be written or removed.
    """
    said, own, names = relative_source(source, folder), _own(folder), list[str]()
    Manifest(said, own, complete=False).write(folder)
    for name in sorted(own, key=lambda each: each not in CLAIMS):
        _remove(folder / name)

    def place(name: str) -> Path:
        names.append(name)
        return folder / name

    yield place
    Manifest(said, {name: content_digest(folder / name) for name in names}).write(folder)


def _remove(path: Path) -> None:
    try:
        path.unlink(missing_ok=True)
    except OSError as error:
        raise OutputError(f"{path}: cannot be removed: {error.strerror}; choose another folder") from error
