"""Files of rows, one JSON document a line, that grow under one writer: a line is whole or not there at all."""

import json
import os
from collections.abc import Iterator, Mapping
from pathlib import Path
from time import monotonic
from typing import Any, Self

from ..errors import OutputError, ResultsError
from .reading import read_bytes

SYNC_EVERY_S = 1.0


class JsonLines:
    """Such a file, open for adding to it. What was left torn at its end by a kill is cut off when it is opened."""

    def __init__(self, path: Path) -> None:
        """Missing parent folders are made. Raises: OutputError if the place cannot be written."""
        self.path = path
        self._synced_s = monotonic()
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            self._file = os.open(path, os.O_RDWR | os.O_CREAT | os.O_APPEND, 0o666)
            os.ftruncate(self._file, path.read_bytes().rfind(b"\n") + 1)
        except OSError as error:
            raise self._wrong(error) from error

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def add(self, row: Mapping[str, Any]) -> None:
        """Add a row in one write; it is on the disk within a second. Raises: OutputError if it cannot be written."""
        line = (json.dumps(row, ensure_ascii=False, allow_nan=False) + "\n").encode()
        before = os.fstat(self._file).st_size
        try:
            if os.write(self._file, line) < len(line):
                raise OSError(28, os.strerror(28))
            if monotonic() - self._synced_s > SYNC_EVERY_S:
                os.fsync(self._file)
                self._synced_s = monotonic()
        except OSError as error:
            os.ftruncate(self._file, before)
            raise self._wrong(error) from error

    def close(self) -> None:
        """What was added is on the disk."""
        os.fsync(self._file)
        os.close(self._file)

    def _wrong(self, error: OSError) -> OutputError:
        return OutputError(
            f"{self.path}: cannot be written: {error.strerror}; free some space or choose another folder"
        )


def read_rows(path: Path) -> Iterator[tuple[int, dict[str, Any]]]:
    """Number of the line, from 1, and its row; without a torn last line, as a kill leaves it. Of no file, nothing.

    Raises: ResultsError for a file that cannot be read, or a damaged line within it.
    """
    try:
        *lines, _ = read_bytes(path).decode().split("\n")
    except FileNotFoundError:
        return
    except (OSError, UnicodeDecodeError) as error:
        why = getattr(error, "strerror", None) or error
        raise ResultsError(f"{path}: cannot be read as rows: {why}; name another folder") from error
    for number, line in enumerate(lines, 1):
        if not line:
            continue
        try:
            row = json.loads(line)
        except ValueError:
            row = None
        if not isinstance(row, dict):
            raise ResultsError(f"{path}:{number}: is not a row; remove the line")
        yield number, row
