"""The folders of results: of one run, complete or marked as incomplete; and of exports.

A list of digests names the files that a later export of the same pipeline may replace.
"""

import json
import os
import tempfile
from collections.abc import Callable, Generator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import asdict, dataclass, field
from itertools import count
from pathlib import Path
from typing import Any, cast

from ...data.products import PRODUCTS
from ...errors import BrokenMethod, OutputError, quoted
from ...files.paths import LEFT
from ...files.reading import MAX_TEXT_BYTES, content_digest, read_bytes
from ...files.writing import sweep, write_text
from ...runtime.system.files import folder_lock

MANIFEST = "manifest.json"
CONFIG, NO_CONFIG, OUTCOMES = "config.yaml", "config.txt", "outcomes.json"
CLAIMS = (CONFIG, NO_CONFIG, OUTCOMES)
RECORDING, SHEET = "recording.npz", "sheet"
GUESSED = "parts-guessed.yaml"  # the pipeline file with guessed heights of parts, to correct
SHEETS = tuple(f"{SHEET}.{drawn_as}" for drawn_as in ("png", "svg", "pdf"))
NAMES = (*CLAIMS, *(f"{product}.npz" for product in PRODUCTS), RECORDING, GUESSED, *SHEETS)
# The list of exported files; the name of no exporter's file begins with a dot.
LISTED = ".exports.json"


@dataclass(frozen=True)
class Manifest:
    """The list of the files that a run wrote into a folder."""

    # The pipeline file, relative to the folder if possible; empty for a pipeline that was made in Python.
    source: str = ""
    files: Mapping[str, str] = field(default_factory=dict[str, str])  # digests of the contents by name
    complete: bool = True  # false while a run writes, and for ever after a run that was killed

    def write(self, folder: Path) -> None:
        """Write the manifest into its folder. Raises: OutputError."""
        plain = {"source": self.source, "complete": self.complete, "files": dict(self.files)}
        write_text(folder / MANIFEST, json.dumps(plain, indent=2) + "\n")


def read_manifest(folder: Path) -> Manifest | None:
    """Read the manifest of a folder; None where it is missing or damaged."""
    try:
        plain = json.loads(read_bytes(folder / MANIFEST, MAX_TEXT_BYTES))
        files = cast("dict[Any, Any]", plain["files"])
        own = {name: digest for name, digest in files.items() if isinstance(digest, str) and Path(name).name == name}
        return Manifest(str(plain["source"]), own, plain["complete"] is True)
    except (OSError, ValueError, TypeError, KeyError, AttributeError, RecursionError):
        return None


def default_folder(source: Path, parent: Path = Path("out"), name: str = "") -> Path:
    """Return `parent`/NAME for the results of this pipeline file, or NAME-2, NAME-3 where that has other files."""
    name = name or default_name(source)
    folders = (parent / (name if number == 1 else f"{name}-{number}") for number in count(1))
    return next(folder for folder in folders if _is_free_for(folder, source))


def default_name(source: Path, *others: Path) -> str:
    """Return the name of a file without its ending, or that of its folder where it is just "left" of a pair."""
    if others and source.stem.casefold() in LEFT:
        return source.resolve().parent.name or source.stem
    ran = source.name == CONFIG and (source.parent / OUTCOMES).exists()
    return source.resolve().parent.name if ran else source.stem


def _is_free_for(folder: Path, source: Path) -> bool:
    manifest = read_manifest(folder)
    if manifest is None:
        return not any((folder / name).exists() for name in NAMES)
    return manifest.source == relative_source(source, folder)


def relative_source(source: Path | None, folder: Path) -> str:
    """Return the path of a pipeline file for a manifest, which stays the same when a project is moved as a whole."""
    if source is None:
        return ""
    try:
        return Path(os.path.relpath(source.resolve(), folder.resolve())).as_posix()
    except ValueError:  # on another drive
        return str(source.resolve())


def make_writable(folder: Path) -> None:
    """Make a folder, try to write a file in it, and delete what killed processes left. Raises: OutputError."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            sweep(folder)
    except OSError as error:
        raise OutputError(f"{folder}: cannot be written: {error.strerror}; choose another folder") from error


def check_folder(folder: Path, source: Path | None) -> None:
    """Make the folder of a run. Raises: OutputError if it cannot be written, or has a file that is not a run's."""
    make_writable(folder)
    _check_files(folder, source)


def _check_files(folder: Path, source: Path | None) -> None:
    own_files = {folder / name for name in _own(folder)}
    if source is not None and source.resolve() == (folder / CONFIG).resolve():  # edited, and run in its place
        own_files.add(folder / CONFIG)
    for path in (folder / name for name in NAMES):
        if path not in own_files and path.exists():
            raise OutputError(f"{path}: exists, and is not an unchanged file of a run; choose another folder")


def _own(folder: Path) -> dict[str, str]:
    """Return the unchanged files of earlier runs with their digests."""
    manifest, there = read_manifest(folder), {name: content_digest(folder / name) for name in NAMES}
    if manifest is None:
        return {}
    if manifest.complete:
        own = {name: digest for name, digest in manifest.files.items() if content_digest(folder / name) == digest}
    else:  # there were no other files when that run began
        own = {**manifest.files, **there}
    return {name: digest for name, digest in own.items() if digest}


@contextmanager
def rewriting(folder: Path, source: Path | None) -> Generator[Callable[[str], Path]]:
    """Delete the files of earlier runs, and keep a manifest of the files that are written in this block."""
    with folder_lock(folder):
        _check_files(folder, source)
        yield from _rewrite(folder, source)


def _rewrite(folder: Path, source: Path | None) -> Generator[Callable[[str], Path]]:
    relative, own, names = relative_source(source, folder), _own(folder), list[str]()
    Manifest(relative, own, complete=False).write(folder)
    # What describes the products goes first and is written last: a killed run leaves no wrong description.
    for name in sorted(own, key=lambda each: each not in CLAIMS):
        _remove(folder / name)

    def place(name: str) -> Path:
        names.append(name)
        return folder / name

    yield place
    Manifest(relative, {name: content_digest(folder / name) for name in names}).write(folder)


def _remove(path: Path) -> None:
    try:
        path.unlink(missing_ok=True)
    except OSError as error:
        raise OutputError(f"{path}: cannot be removed: {error.strerror}; choose another folder") from error


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
