"""The cache: records on disk by the keys of their making, an entry `<key>.npz` each, which appears whole."""

import json
import logging
import os
import re
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import fields, is_dataclass
from itertools import chain
from math import inf
from pathlib import Path
from typing import Any, NamedTuple, cast, get_args

import numpy as np

from ... import data
from ...data import Note, NoteKind, Record
from ...errors import OutputError, quoted, shown
from ...files.arrays import Archive, write_arrays
from ...files.paths import as_path
from ...files.reading import check_file
from ...files.writing import atomic_write, leftovers, sweep, temporary_paths
from ...runtime.system.files import BINARY

log: logging.Logger = logging.getLogger(__name__)

DEFAULT_BYTES = 2 << 30
# The share of the limit that is left after pruning: the next results then fit without counting the files.
LEFT = 7 / 8
TALLY = ".tally"
# The numbers of a tally that are read; a longer one is unknown, and counting the folder again makes it short.
MAX_NUMBERS = 1 << 17
NOTES = "notes"
_OURS = re.compile(r"[0-9a-f]{32,64}\.npz")  # the names of entries: the folder may hold other files too
# Folders of which the log has a warning: one for each folder, not for each result.
_unwritable: set[Path] = set()
KEPT = frozenset(name for name in dir(data) if is_dataclass(getattr(data, name)))
"""The names of the classes that an entry may be made of."""


Notes = Mapping[str, tuple[Note, ...]]


class Entry(NamedTuple):
    """A record with the notes on it and on all products that it was made from."""

    record: Record
    notes: Notes


class Tally:
    """A file of numbers whose sum is the size of the folder in bytes: a count, and after it each writer's additions.

    Eight bytes are appended at once, and no other writer comes between, so there is no lock. The addition of a killed
    process is missing until the folder is counted again, and an entry that is written twice is counted twice.
    """

    def __init__(self, path: Path) -> None:
        self.path = path

    def add(self, size: int) -> int | None:
        """Add a size and return the sum; None where it is unknown, and the folder must be counted."""
        try:
            file = os.open(self.path, os.O_RDWR | os.O_APPEND | BINARY)
        except FileNotFoundError:
            return None
        try:
            os.write(file, size.to_bytes(8, "little"))
            os.lseek(file, 0, os.SEEK_SET)
            content = os.read(file, 8 * MAX_NUMBERS)
        finally:
            os.close(file)
        if len(content) % 8 or len(content) in (8, 8 * MAX_NUMBERS):  # this number alone, or more than is read
            return None
        numbers = np.frombuffer(content, "<i8")
        return None if numbers.min() < 0 else int(numbers.sum())

    def begin(self, total: int) -> None:
        """Start with a counted size. Raises: OutputError if the file cannot be written."""
        with atomic_write(self.path) as file:
            file.write(total.to_bytes(8, "little"))


class Cache:
    """A folder of records, bounded in size: the entries used longest ago are deleted first."""

    def __init__(self, folder: Path | None = None, max_bytes: int = DEFAULT_BYTES) -> None:
        self.folder: Path = default_folder() if folder is None else folder
        self.max_bytes = max_bytes
        self._tally = Tally(self.folder / TALLY)

    def __contains__(self, key: str) -> bool:
        try:
            return self._path(key).is_file()
        except OSError:  # the folder may not be looked into
            return False

    def entry(self, key: str) -> Entry | None:
        """Return the record of this key with its notes; None without one. A damaged one is deleted, with a warning."""
        path = self._path(key)
        try:
            entry = read_entry(path)
            os.utime(path)  # least recently used, not oldest, goes first
        except FileNotFoundError:  # or dropped by another process while it was read
            return None
        except MemoryError:  # which is no damage
            raise
        except Exception as error:  # noqa: BLE001 - a damaged file can provoke any
            if self._is_there():
                log.warning("cache entry %s is damaged and is made again: %s", path, shown(str(error), 200))
                _remove(path)
            return None
        return entry

    def notes(self, key: str) -> Notes:
        """Return only the notes of this key, for a plan; none where there is no such entry, or it is damaged."""
        try:
            check_file(self._path(key))
            with self._path(key).open("rb") as file:
                return _notes(Archive(file).read([NOTES])[NOTES])
        except Exception:  # noqa: BLE001 - a damaged file can provoke any; `entry` logs it
            return {}

    def put(self, key: str, record: Record, notes: Notes | None = None) -> None:
        """Keep a record; where the cache cannot be written, there is a warning and no error."""
        try:
            write_record(self._path(key), record, notes or {})
            total = self._tally.add(_use_and_size(self._path(key))[1])
            if total is None or total > self.max_bytes:
                self._prune()
        except (OutputError, OSError) as error:
            if self.folder not in _unwritable:
                _unwritable.add(self.folder)
                log.warning("results are not cached: %s; TANGIBLE_CACHE_DIR names another cache", error)

    def _is_there(self) -> bool:
        """Return True if the cache is a folder; about anything else in its place `put` warns."""
        try:
            return self.folder.is_dir()
        except OSError:
            return False

    def size(self) -> tuple[int, int]:
        """Return the number of results and their size in bytes, with unfinished ones."""
        sizes = [_use_and_size(path)[1] for path in (*self._results(), *temporary_paths(self.folder))]
        return len(sizes), sum(sizes)

    def clear(self) -> tuple[int, int]:
        """Delete every result, and nothing else, and return their number and bytes; what is being written stays."""
        sizes: list[int] = []
        for path in chain(self._results(), leftovers(self.folder, age_s=-inf)):
            size = _use_and_size(path)[1]
            try:
                path.unlink(missing_ok=True)
            except OSError as error:
                raise OutputError(f"{path}: cannot be deleted: {error.strerror}") from error
            sizes.append(size)
        self._tally.path.unlink(missing_ok=True)
        return len(sizes), sum(sizes)

    def _results(self) -> list[Path]:
        return [path for path in self.folder.glob("*.npz") if _OURS.fullmatch(path.name) and path.is_file()]

    def _path(self, key: str) -> Path:
        return self.folder / f"{key}.npz"

    def _prune(self) -> None:
        sweep(self.folder)
        entries = [(*_use_and_size(path), path) for path in self.folder.glob("*.npz")]
        total = sum(size for _, size, _ in entries)
        if total > self.max_bytes:
            for _, size, path in sorted(entries):
                log.info("cache is over %d MiB: %s is dropped", self.max_bytes >> 20, path.name)
                path.unlink(missing_ok=True)
                total -= size
                if total <= LEFT * self.max_bytes:
                    break
        self._tally.begin(total)


def default_folder() -> Path:
    """Return $TANGIBLE_CACHE_DIR, or the user's cache folder."""
    if variable := os.environ.get("TANGIBLE_CACHE_DIR"):
        return as_path(variable, "TANGIBLE_CACHE_DIR")
    from platformdirs import user_cache_path

    return user_cache_path("tangible-images")


def write_record(path: Path, record: Record, notes: Notes | None = None) -> None:
    """Write a record as an .npz: its arrays by name, and the rest in `record` and `notes` as JSON."""
    arrays: dict[str, np.ndarray] = {}
    texts = {"record": _pack(record, "", arrays)}
    if notes is not None:
        texts[NOTES] = {product: [[note.text, note.kind] for note in notes[product]] for product in notes}
    text_bytes = {name: np.frombuffer(json.dumps(tree).encode(), np.uint8) for name, tree in texts.items()}
    with atomic_write(path) as file:
        write_arrays(file, text_bytes | arrays)


def read_entry(path: Path) -> Entry:
    """Read a record and its notes. Raises: FileNotFoundError; ValueError or other errors if it is damaged."""
    check_file(path)
    with path.open("rb") as file:
        archive = Archive(file)
        arrays = archive.read(archive.names)
    notes: Notes = _notes(arrays.pop(NOTES)) if NOTES in arrays else {}
    record = _unpack(json.loads(arrays.pop("record").tobytes()), arrays)
    if not isinstance(record, Record):
        raise ValueError(f"has {quoted(record)} in place of a record")
    return Entry(record, notes)


def _notes(data_bytes: np.ndarray) -> Notes:
    notes = json.loads(data_bytes.tobytes())
    return {str(product): tuple(_note(*note) for note in of_product) for product, of_product in notes.items()}


def _note(text: Any, kind: Any) -> Note:
    if not isinstance(text, str) or kind not in get_args(NoteKind):
        raise ValueError(f"has {quoted([text, kind])} in place of a note")
    return Note(text, kind)


def _pack(value: Any, name: str, arrays: dict[str, np.ndarray]) -> Any:
    if isinstance(value, np.ndarray):
        arrays[name] = value
        return {"array": name}
    if is_dataclass(value):
        parts = {f.name: _pack(getattr(value, f.name), f"{name}.{f.name}".strip("."), arrays) for f in fields(value)}
        return {"class": type(value).__name__, "fields": parts}
    if isinstance(value, tuple):
        items = cast("tuple[Any, ...]", value)
        return {"tuple": [_pack(part, f"{name}.{i}", arrays) for i, part in enumerate(items)]}
    return value


def _unpack(tree: Any, arrays: Mapping[str, np.ndarray]) -> Any:
    match tree:
        case {"array": name}:
            return arrays[name]
        case {"class": str(name), "fields": parts} if name in KEPT:
            return getattr(data, name)(**{key: _unpack(part, arrays) for key, part in parts.items()})
        case {"tuple": items}:
            return tuple(_unpack(part, arrays) for part in items)
        case None | bool() | int() | float() | str():
            return tree
        case _:
            raise ValueError(f"unknown entry {quoted(tree)}")


def _remove(path: Path) -> None:
    """Delete a damaged entry. A folder with something in it stays, as it is not ours, and `put` warns about it."""
    with suppress(OSError):
        if path.is_dir() and not path.is_symlink():
            path.rmdir()
        else:
            path.unlink()


def _use_and_size(path: Path) -> tuple[float, int]:
    try:
        status = path.stat()
    except FileNotFoundError:  # another process dropped it
        return 0.0, 0
    return status.st_mtime, status.st_size
