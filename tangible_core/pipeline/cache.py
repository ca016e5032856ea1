"""Records on disk, found by the key of what made them.

One file an entry, `<key>.npz`: readable by numpy.load, checked by the archive's CRC when it is read. Files appear whole
(written beside and renamed), so two processes can share a folder; a damaged entry is deleted and made again.
"""

import json
import logging
import os
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import Any, cast

import numpy as np

from .. import data
from ..data import Record
from ..errors import OutputError, quoted, shown
from ..files.arrays import Archive
from ..files.paths import as_path
from ..files.reading import check_file
from ..files.writing import atomic_write

log = logging.getLogger(__name__)

DEFAULT_BYTES = 2 << 30
_unwritable: set[Path] = set()
"""Folders that were complained of: each once, not for each result."""
KEPT = frozenset(name for name, each in vars(data).items() if is_dataclass(each))
"""What an entry may be made of."""


class Cache:
    """A folder of records, bounded in size: the entries used longest ago go first."""

    def __init__(self, folder: Path | None = None, max_bytes: int = DEFAULT_BYTES) -> None:
        self.folder = default_folder() if folder is None else folder
        self.max_bytes = max_bytes

    def __contains__(self, key: str) -> bool:
        try:
            return self._path(key).is_file()
        except OSError:  # the folder may not be looked into
            return False

    def get(self, key: str) -> Record | None:
        """The record of this key, or None if there is none or it is damaged (then it is deleted and said)."""
        path = self._path(key)
        try:
            record = read_record(path)
            os.utime(path)  # least recently used, not oldest, goes first
        except FileNotFoundError:  # or dropped by another process while it was read
            return None
        except Exception as error:  # noqa: BLE001 - a damaged file can provoke any
            if self._is_there():
                log.warning("cache entry %s is damaged and is made again: %s", path, shown(str(error), 200))
                _remove(path)
            return None
        return record

    def put(self, key: str, record: Record) -> None:
        """Keep a record; a cache that cannot be written costs a warning, never the result."""
        try:
            write_record(self._path(key), record)
            self._prune()
        except (OutputError, OSError) as error:
            if self.folder not in _unwritable:
                _unwritable.add(self.folder)
                log.warning("results are not cached: %s; TANGIBLE_CACHE_DIR names another cache", error)

    def _is_there(self) -> bool:
        """Whether there is a folder to hold entries; of what stands in its place, `put` complains."""
        try:
            return self.folder.is_dir()
        except OSError:
            return False

    def _path(self, key: str) -> Path:
        return self.folder / f"{key}.npz"

    def _prune(self) -> None:
        entries = sorted((_used(path), path) for path in self.folder.glob("*.npz"))
        excess = sum(size for (_, size), _ in entries) - self.max_bytes
        for (_, size), path in entries:
            if excess <= 0:
                return
            log.info("cache is over %d MiB: %s is dropped", self.max_bytes >> 20, path.name)
            path.unlink(missing_ok=True)
            excess -= size


def default_folder() -> Path:
    """$TANGIBLE_CACHE_DIR, or the user's cache folder."""
    if named := os.environ.get("TANGIBLE_CACHE_DIR"):
        return as_path(named, "TANGIBLE_CACHE_DIR")
    from platformdirs import user_cache_path

    return user_cache_path("tangible-images")


def write_record(path: Path, record: Record) -> None:
    """A record as an uncompressed .npz: its arrays by name, and the rest in `record` as JSON.

    Raises: OutputError if the place cannot be written.
    """
    arrays: dict[str, np.ndarray] = {}
    tree = json.dumps(_pack(record, "", arrays))
    with atomic_write(path) as file:
        np.savez(file, allow_pickle=False, record=np.frombuffer(tree.encode(), np.uint8), **cast(Any, arrays))


def read_record(path: Path) -> Record:
    """What `write_record` wrote. Raises: FileNotFoundError, or ValueError and its like when damaged."""
    check_file(path)
    with path.open("rb") as file:
        archive = Archive(file)
        arrays = archive.read(archive.names)
    record = _unpack(json.loads(arrays.pop("record").tobytes()), arrays)
    if not isinstance(record, Record):
        raise ValueError(f"holds no record, but {quoted(record)}")
    return record


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
    """A damaged entry. A folder that holds something is somebody's: it stays, and `put` complains of it."""
    with suppress(OSError):
        if path.is_dir() and not path.is_symlink():
            path.rmdir()
        else:
            path.unlink()


def _used(path: Path) -> tuple[float, int]:
    try:
        found = path.stat()
    except FileNotFoundError:  # another process dropped it
        return 0.0, 0
    return found.st_mtime, found.st_size
