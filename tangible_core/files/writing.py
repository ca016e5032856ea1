"""Files that are whole or not there at all, and files that grow under one writer."""

import os
import sys
import tempfile
from collections.abc import Generator
from contextlib import contextmanager, suppress
from io import FileIO
from pathlib import Path
from typing import IO

from ..errors import OutputError

BINARY = getattr(os, "O_BINARY", 0)
"""Of a file opened by `os.open`, on the one system that knows another kind."""


@contextmanager
def atomic_write(path: Path) -> Generator[IO[bytes]]:
    """A binary file that appears under its name only once the block has ended well.

    The file is written beside its place and renamed, so a reader, a second writer, a full disk or a kill
    never sees half of it. Missing parent folders are made.
    Raises: OutputError if the place cannot be written.
    """
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        handle, name = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.")
    except OSError as error:
        raise OutputError(f"{path}: cannot be written: {error.strerror}; choose another folder") from error
    part = Path(name)
    try:
        with os.fdopen(handle, "wb") as file:
            yield file
        part.chmod(0o666 & ~_umask())
        part.replace(path)
    except OSError as error:
        raise OutputError(
            f"{path}: cannot be written: {error.strerror}; free some space or choose another folder"
        ) from error
    finally:
        part.unlink(missing_ok=True)


def write_text(path: Path, text: str) -> None:
    """Write a text file whole (see `atomic_write`)."""
    with atomic_write(path) as file:
        file.write(text.encode())


def open_alone(path: Path) -> FileIO:
    """An empty binary file, unbuffered, that nobody else opens so before it is closed, or this process ended.

    Missing parent folders are made. What stood there before is gone, but not when another one holds it.
    Raises: OutputError if the place cannot be written, or is held.
    """
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        file = FileIO(os.open(path, os.O_RDWR | os.O_CREAT | BINARY, 0o666), "r+")
    except OSError as error:
        raise OutputError(f"{path}: cannot be written: {error.strerror}; choose another folder") from error
    try:
        lock(file)
        file.truncate(0)
    except OSError as error:
        file.close()
        if isinstance(error, BlockingIOError | PermissionError):
            cure = "another program is writing to it; end that one or choose another name"
        else:
            cure = f"cannot be written: {error.strerror}; choose another folder"
        raise OutputError(f"{path}: {cure}") from error
    return file


def lock(file: FileIO) -> None:
    """Hold an open file until it is closed, or this process ends. Raises: OSError if another one has it."""
    if sys.platform == "win32":
        import msvcrt

        file.seek(2**62)  # what is locked cannot be read by others on this system: a byte that will never be there
        msvcrt.locking(file.fileno(), msvcrt.LK_NBLCK, 1)
        file.seek(0)
    else:
        import fcntl

        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)


@contextmanager
def alone_in(folder: Path) -> Generator[None]:
    """In a block, one program at a time; the others wait. Where a file system knows no locks, nobody waits."""
    if sys.platform == "win32":
        with FileIO(os.open(folder / ".alone", os.O_RDWR | os.O_CREAT | os.O_TEMPORARY), "r+") as file:
            import msvcrt

            msvcrt.locking(file.fileno(), msvcrt.LK_LOCK, 1)
            yield
    else:
        import fcntl

        number = os.open(folder, os.O_RDONLY)
        try:
            with suppress(OSError):
                fcntl.flock(number, fcntl.LOCK_EX)
            yield
        finally:
            os.close(number)


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask
