"""Atomic writes, and files that only one process writes to at a time."""

import os
import re
import shutil
import time
from collections.abc import Generator
from contextlib import contextmanager, suppress
from hashlib import sha256
from io import FileIO
from pathlib import Path
from typing import IO

from ..errors import OutputError
from ..runtime.system.files import BINARY, folder_lock, is_in_use, left_by_others, lock, wait_for_lock

# Number of characters of a file's name in the name of its temporary file: of four bytes each, they still fit.
MAX_OF_NAME = 50
TEMPORARY = re.compile(r"\..*\.[0-9a-f]{12}\.tangible")
LEFT_S = 60.0
"""Age from which a temporary file that nobody has locked was left by a process that was killed, seconds."""


@contextmanager
def atomic_write(path: Path, *, private: bool = False) -> Generator[IO[bytes]]:
    """Open a binary file that appears under its name only if the block ends without an error.

    The content goes to a temporary file in the same folder, which is then renamed: readers, a second writer, a full
    disk or a kill never leave half a file. Missing parent folders are created. private: for this user alone.
    Raises: OutputError if the file cannot be written.
    """
    part = _temporary(path)
    try:
        handle = _create(part, os.O_WRONLY | os.O_EXCL, private)
    except OSError as error:
        raise OutputError(f"{path}: cannot be written: {error.strerror or error}; choose another folder") from error
    try:
        with os.fdopen(handle, "wb") as file:
            wait_for_lock(handle)
            yield file
        part.replace(path)
    except OSError as error:
        if is_in_use(error, path):
            raise OutputError(f"{path}: another program has it open; close it there or choose another name") from error
        raise OutputError(
            f"{path}: cannot be written: {error.strerror or error}; free some space or choose another folder"
        ) from error
    finally:
        part.unlink(missing_ok=True)


@contextmanager
def temporary_folder(path: Path) -> Generator[Path]:
    """Make a folder beside this path, named after it, for a block. Raises: OSError if it cannot be made."""
    folder = _temporary(path)
    folder.mkdir()
    try:
        with folder_lock(folder):
            yield folder
    finally:
        shutil.rmtree(folder, ignore_errors=True)


@contextmanager
def sole_writer(path: Path) -> Generator[None]:
    """Write files that belong together, such as those of a run, in a block that no other process is in.

    path: one of them, or what their names have in common. A missing folder is created. A process that ends is out of
    its block, and where the file system has no locks, nobody is refused.
    Raises: OutputError if another process is in such a block for this path, or the folder cannot be written.
    """
    claim = _temporary(path, sha256(os.fsencode(path.name)).hexdigest()[:12])
    with _claim(claim) as file:
        try:
            yield
        finally:
            try:
                claim.unlink(missing_ok=True)
            except PermissionError:  # Windows deletes no open file
                file.close()
                claim.unlink(missing_ok=True)


def _claim(path: Path) -> FileIO:
    """Create a file, and lock it. Raises: OutputError if another process holds it, or it cannot be created."""
    while True:
        try:
            file = FileIO(_create(path, os.O_RDWR, False), "r+")
        except OSError as error:
            raise OutputError(
                f"{path.parent}: cannot be written: {error.strerror or error}; choose another folder"
            ) from error
        if _is_taken(file):
            file.close()
            raise OutputError(
                f"{path.parent}: another program is writing the same files there; wait for it or choose another folder"
            )
        with suppress(FileNotFoundError):
            if os.path.samestat(os.fstat(file.fileno()), path.stat()):
                return file
        file.close()  # between its opening and its lock, who had it before has deleted it


def sweep(folder: Path) -> None:
    """Delete temporary files and folders that killed processes left in a folder; on Windows, no folders."""
    for path in leftovers(folder):
        with suppress(OSError):
            shutil.rmtree(path) if path.is_dir() else path.unlink()


def leftovers(folder: Path, age_s: float = LEFT_S) -> Generator[Path]:
    """Yield the temporary files and folders of at least this age that killed processes left in a folder."""
    for path in temporary_paths(folder):
        with suppress(OSError):
            if time.time() - path.lstat().st_mtime > age_s:
                with left_by_others(path):
                    yield path


def temporary_paths(folder: Path) -> list[Path]:
    """Return the temporary files and folders in a folder, in use or left by killed processes."""
    return [path for path in folder.glob(".*.tangible") if TEMPORARY.fullmatch(path.name)]


def write_text(path: Path, text: str, *, private: bool = False) -> None:
    """Write a text file, whole or not at all (see `atomic_write`)."""
    with atomic_write(path, private=private) as file:
        file.write(text.encode(errors="backslashreplace"))  # as JSON has it: names of files may hold half a character


def open_alone(path: Path, *, private: bool = False) -> FileIO:
    """Open an empty, unbuffered binary file that no other call can open until it is closed or this process ends."""
    try:
        file = FileIO(_create(path, os.O_RDWR, private), "r+")
    except OSError as error:
        raise OutputError(f"{path}: cannot be written: {error.strerror or error}; choose another folder") from error
    try:
        lock(file)
        file.truncate(0)
    except OSError as error:
        file.close()
        if isinstance(error, BlockingIOError | PermissionError):
            cure = "another program is writing to it; end that one or choose another name"
        else:
            cure = f"cannot be written: {error.strerror or error}; choose another folder"
        raise OutputError(f"{path}: {cure}") from error
    return file


def _temporary(path: Path, digits: str = "") -> Path:
    return path.parent / f".{path.name[:MAX_OF_NAME]}.{digits or os.urandom(6).hex()}.tangible"


def _is_taken(file: FileIO) -> bool:
    """Lock an open file; return True if another process holds it, and False where the file system has no locks."""
    try:
        lock(file)
    except OSError as error:
        return isinstance(error, BlockingIOError | PermissionError)
    return False


def _create(path: Path, flags: int, private: bool) -> int:
    """Create a file with its folders, and open it. The system applies the umask. Raises: OSError."""
    path.parent.mkdir(0o700 if private else 0o777, parents=True, exist_ok=True)
    return os.open(path, flags | os.O_CREAT | BINARY, 0o600 if private else 0o666)
