"""Text and JSON Lines files that one process appends to: each line is whole or absent, whatever ends the process."""

import errno
import json
import os
from collections.abc import Iterator, Mapping
from io import FileIO
from pathlib import Path
from time import monotonic
from typing import Any, Self, cast

from ..errors import OutputError, ResultsError
from ..runtime.system.files import BINARY, lock
from .reading import check_file


class LineFile:
    """A text file, open for appending. Opening it removes a last line that a kill left incomplete."""

    def __init__(self, path: Path, *, sync_every_s: float = 0.0, in_use: str = "", header: str = "") -> None:
        """Open the file; missing parent folders are created.

        sync_every_s: the longest time until a line is on the disk; 0 waits for the disk at each line. in_use: what to
        say if another process holds the file, which is then locked; "" leaves it open to others. header: the first line
        of a new file.
        Raises: OutputError if the file cannot be written, or another process holds it.
        """
        self.path = path
        self._sync_every_s, self._synced_s = sync_every_s, monotonic()
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            self._file = FileIO(os.open(path, os.O_RDWR | os.O_CREAT | os.O_APPEND | BINARY, 0o666), "a+")
        except OSError as error:
            raise self._wrong(error) from error
        try:
            if in_use:
                lock(self._file)
            self._cut_torn_end()
            if header and not self._size():
                self._append(header)
        except OSError as error:
            self._file.close()
            if in_use and isinstance(error, BlockingIOError | PermissionError):
                raise OutputError(f"{path}: {in_use}") from error
            raise self._wrong(error) from error

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def add(self, line: str) -> None:
        """Add a line in one write. Raises: OutputError if it cannot be written; the file is then as before."""
        before = self._size()
        try:
            self._append(line)
        except OSError as error:
            self._file.truncate(before)
            raise self._wrong(error) from error

    def close(self) -> None:
        """Close the file, with all lines on the disk. Raises: OutputError if the disk does not take them."""
        try:
            self._sync()
        except OSError as error:
            raise self._wrong(error) from error
        finally:
            self._file.close()

    def _size(self) -> int:
        return os.fstat(self._file.fileno()).st_size

    def _append(self, line: str) -> None:
        data = f"{line}\n".encode(errors="backslashreplace")  # names of files may hold half a character
        if self._file.write(data) < len(data):
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        if monotonic() - self._synced_s >= self._sync_every_s:
            self._sync()

    def _cut_torn_end(self) -> None:
        """Remove an incomplete last line; a file is opened anew for each row, so only its last byte is read first."""
        if not self._file.seek(0, os.SEEK_END):
            return
        self._file.seek(-1, os.SEEK_END)
        if self._file.read(1) != b"\n":
            self._file.truncate(self.path.read_bytes().rfind(b"\n") + 1)

    def _sync(self) -> None:
        os.fsync(self._file.fileno())
        self._synced_s = monotonic()

    def _wrong(self, error: OSError) -> OutputError:
        return OutputError(
            f"{self.path}: cannot be written: {error.strerror}; free some space or choose another folder"
        )


def read_lines(path: Path) -> Iterator[tuple[int, str]]:
    """Yield the number of each line, from 1, and the line, without empty lines and an incomplete last line."""
    check_file(path)
    with path.open("rb") as file:
        for number, line in enumerate(file, 1):
            if line.endswith(b"\n") and line != b"\n":
                yield number, line[:-1].decode()


SYNC_EVERY_S = 1.0  # the longest time, s, until a row is on the disk
IN_USE = "another program is writing to it; wait for that one or choose another folder"


class JsonLines(LineFile):
    """A JSON Lines file, open for appending."""

    def __init__(self, path: Path, sync_every_s: float = SYNC_EVERY_S, alone: bool = False) -> None:
        """Open the file; sync_every_s: the longest time until a row is on the disk. alone: lock it."""
        super().__init__(path, sync_every_s=sync_every_s, in_use=IN_USE if alone else "")

    def add_row(self, row: Mapping[str, Any]) -> None:
        """Add a row in one write. Raises: OutputError if it cannot be written; the file is then as before."""
        self.add(json.dumps(row, ensure_ascii=False, allow_nan=False))


def read_rows(path: Path) -> Iterator[tuple[int, dict[str, Any]]]:
    """Yield the number of each line, from 1, and its row; nothing if the file does not exist."""
    try:
        for number, line in read_lines(path):
            yield number, _row(path, number, line)
    except FileNotFoundError:
        return
    except (OSError, UnicodeDecodeError) as error:
        why = getattr(error, "strerror", None) or error
        raise ResultsError(f"{path}: cannot be read as rows: {why}; name another folder") from error


def _row(path: Path, number: int, line: str) -> dict[str, Any]:
    try:
        row = json.loads(line)
    except (ValueError, RecursionError):
        row = None
    if not isinstance(row, dict):
        raise ResultsError(f"{path}:{number}: is not a row; remove the line")
    return cast("dict[str, Any]", row)
