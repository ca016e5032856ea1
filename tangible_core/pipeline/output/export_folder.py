"""The folder of exports: a list of digests names the files that a later export of the same pipeline may replace."""

import json
import os
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, cast

from ...errors import BrokenMethod, OutputError, quoted
from ...files.reading import content_digest, read_bytes
from ...files.writing import write_text
from ...runtime.system.files import folder_lock
from .run_folder import make_writable

# The list of exported files; the name of no exporter's file begins with a dot.
LISTED = ".exports.json"


@dataclass(frozen=True)
class Listed:
    """An exported file."""

    # The pipeline file, relative to the folder if possible; empty for a pipeline that was made in Python.
    source: str
    exporter: str
    digest: str


def check_writable(folder: Path) -> None:
    """Make the folder. Raises: OutputError if it cannot be written, or if its list is another program's file."""
    make_writable(folder)
    if os.path.lexists(folder / LISTED) and _read_list(folder) is None:
        raise OutputError(f"{folder / LISTED}: is not a list of exports; move or delete it, or choose another folder")


def check_written(paths: Sequence[object], place: Path, who: str) -> tuple[Path, ...]:
    """Check the paths that an exporter returned. place: its `stem`. who: the exporter's name for messages."""
    if not paths:
        raise BrokenMethod(f"{who}: write returned no path; it must return those of all files that it wrote")
    for path in paths:
        if not isinstance(path, Path):
            raise BrokenMethod(f"{who}: write returned {quoted(path)} for a path; it must return a tuple of Path")
        if path.absolute().parent != place.absolute().parent or not path.name.startswith(place.name):
            raise BrokenMethod(f"{who}: write returned {path}, which is not the given stem with an ending")
        if path.is_symlink() or not path.is_file():
            raise BrokenMethod(f"{who}: write returned {path.name}, and there is no such file")
    return tuple(dict.fromkeys(cast("Sequence[Path]", paths)))


def move(paths: Sequence[Path], folder: Path, source: str, exporter: str, force: bool) -> tuple[Path, ...]:
    """Move files to their place, all or none; `force` overwrites files that are not an earlier export."""
    with folder_lock(folder):
        return _replace(paths, folder, source, exporter, force)


def _replace(paths: Sequence[Path], folder: Path, source: str, exporter: str, force: bool) -> tuple[Path, ...]:
    before = read_list(folder)
    places = {entry: folder / entry.name for entry in paths}
    for place in places.values():
        if place.is_dir() or (place.exists() and not force and not _is_ours(place, before, source, exporter)):
            raise OutputError(
                f"{place}: is there already, and is not an unchanged export of this pipeline; --out FOLDER writes to "
                f"another folder{'' if place.is_dir() else ', --force overwrites it'}"
            )
    new = {place.name: Listed(source, exporter, content_digest(path)) for path, place in places.items()}
    list_file = paths[0].with_name(LISTED)  # beside the files, so that a full disk shows before any of them is moved
    _write_list(list_file, {name: entry for name, entry in before.items() if (folder / name).is_file()} | new)
    for path, place in {**places, list_file: folder / LISTED}.items():
        try:
            path.replace(place)
        except OSError as error:
            raise OutputError(f"{place}: cannot be written: {error.strerror}; choose another folder") from error
    return tuple(places.values())


def read_list(folder: Path) -> dict[str, Listed]:
    """Return the files that were exported into a folder, by name; none where the list is missing or damaged."""
    return _read_list(folder) or {}


def _read_list(folder: Path) -> dict[str, Listed] | None:
    try:
        plain = json.loads(read_bytes(folder / LISTED))
        return {str(name): Listed(**fields) for name, fields in cast("dict[Any, Any]", plain["files"]).items()}
    except (OSError, ValueError, TypeError, KeyError, AttributeError, RecursionError):
        return None


def _write_list(path: Path, files: Mapping[str, Listed]) -> None:
    plain = {name: asdict(files[name]) for name in sorted(files)}
    write_text(path, json.dumps({"files": plain}, indent=2, ensure_ascii=False) + "\n")


def _is_ours(place: Path, before: Mapping[str, Listed], source: str, exporter: str) -> bool:
    """Return True for an unchanged file of an earlier export by the same pipeline and exporter."""
    return before.get(place.name) == Listed(source, exporter, content_digest(place))
