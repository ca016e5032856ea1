"""The folder of exports: each exporter's files come there once all of them are whole, and nobody else's are lost.

A list names the files that were exported, with a digest of each, so that a later export of the same pipeline takes
their place, and that of no other file.
"""

import json
import os
import tempfile
from collections.abc import Generator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, cast

from ...errors import BrokenMethod, OutputError, quoted
from ...files.reading import content_digest, read_bytes
from ...files.writing import folder_lock, write_text

LISTED = ".exports.json"
"""What an export leaves beside its files: no file of an exporter begins with a dot."""


@dataclass(frozen=True)
class Listed:
    """An exported file."""

    source: str
    """The pipeline file, relative to the folder where it can be; empty for one that was made in Python."""
    exporter: str
    digest: str


def check_writable(folder: Path) -> None:
    """Make the folder. Raises: OutputError if it cannot be written, or if its list is somebody else's file."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            pass
    except OSError as error:
        raise OutputError(f"{folder}: cannot be written: {error.strerror}; choose another folder") from error
    if os.path.lexists(folder / LISTED) and _listed(folder) is None:
        raise OutputError(f"{folder / LISTED}: is no list of exports; take it away, or choose another folder")


@contextmanager
def scratch(folder: Path) -> Generator[Path]:
    """A folder beside the place of the files, in which they are written; it is gone after the block."""
    with tempfile.TemporaryDirectory(prefix=".export-", dir=folder, ignore_cleanup_errors=True) as name:
        yield Path(name)


def check_written(written: Sequence[object], place: Path, who: str) -> tuple[Path, ...]:
    """What an exporter says that it wrote. place: the `stem` that it was given. who: the exporter, in words.

    Raises: BrokenMethod if these are not files of its own folder that begin with the stem.
    """
    if not written:
        raise BrokenMethod(f"{who}: write gave no path; it must give those of all files that it wrote")
    for each in written:
        if not isinstance(each, Path):
            raise BrokenMethod(f"{who}: write gave {quoted(each)} for a path; it must give a tuple of Path")
        if each.absolute().parent != place.absolute().parent or not each.name.startswith(place.name):
            raise BrokenMethod(f"{who}: write gave {each}, which is not the stem that it was given with an ending")
        if each.is_symlink() or not each.is_file():
            raise BrokenMethod(f"{who}: write gave {each.name}, and there is no such file")
    return tuple(dict.fromkeys(cast("Sequence[Path]", written)))


def move(written: Sequence[Path], folder: Path, source: str, exporter: str, force: bool) -> tuple[Path, ...]:
    """Bring files to their place. force: over files that are no earlier export of the same source, too.

    Raises: OutputError if one would be written over, before any is moved.
    """
    with folder_lock(folder):
        return _moved(written, folder, source, exporter, force)


def _moved(written: Sequence[Path], folder: Path, source: str, exporter: str, force: bool) -> tuple[Path, ...]:
    before = read_list(folder)
    places = {each: folder / each.name for each in written}
    for place in places.values():
        if place.is_dir() or (place.exists() and not force and not _is_ours(place, before, source, exporter)):
            raise OutputError(
                f"{place}: is there already, and no export of this left it so; --out FOLDER writes to another folder"
                + ("" if place.is_dir() else ", --force writes over it")
            )
    new = {place.name: Listed(source, exporter, content_digest(path)) for path, place in places.items()}
    for path, place in places.items():
        try:
            path.replace(place)
        except OSError as error:
            raise OutputError(f"{place}: cannot be written: {error.strerror}; choose another folder") from error
    _write_list(folder, {**before, **new})
    return tuple(places.values())


def read_list(folder: Path) -> dict[str, Listed]:
    """The files that were exported into a folder, by name; none where no list of them can be read."""
    return _listed(folder) or {}


def _listed(folder: Path) -> dict[str, Listed] | None:
    try:
        plain = json.loads(read_bytes(folder / LISTED))
        return {str(name): Listed(**said) for name, said in cast("dict[Any, Any]", plain["files"]).items()}
    except (OSError, ValueError, TypeError, KeyError, AttributeError, RecursionError):
        return None


def _write_list(folder: Path, files: Mapping[str, Listed]) -> None:
    there = {name: asdict(files[name]) for name in sorted(files) if (folder / name).is_file()}
    write_text(folder / LISTED, json.dumps({"files": there}, indent=2, ensure_ascii=False) + "\n")


def _is_ours(place: Path, before: Mapping[str, Listed], source: str, exporter: str) -> bool:
    """Whether an earlier export of the same left the file as it is."""
    return before.get(place.name) == Listed(source, exporter, content_digest(place))
