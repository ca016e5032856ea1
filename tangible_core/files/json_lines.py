"""JSON Lines files that one process appends to: each row is whole or absent."""

import json
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, cast

from ..errors import ResultsError
from .line_file import LineFile, read_lines

SYNC_EVERY_S = 1.0
"""The longest time, s, until a row is on the disk."""
IN_USE = "another program is writing to it; wait for that one or choose another folder"


class JsonLines(LineFile):
    """A JSON Lines file, open for appending."""

    def __init__(self, path: Path, sync_every_s: float = SYNC_EVERY_S, alone: bool = False) -> None:
        """Open the file; missing parent folders are created.

        sync_every_s: the longest time until a row is on the disk. alone: lock the file against other processes.
        Raises: OutputError if the file cannot be written, or another process holds it.
        """
        super().__init__(path, sync_every_s=sync_every_s, in_use=IN_USE if alone else "")

    def add_row(self, row: Mapping[str, Any]) -> None:
        """Add a row in one write. Raises: OutputError if it cannot be written; the file is then as before."""
        self.add(json.dumps(row, ensure_ascii=False, allow_nan=False))


def read_rows(path: Path) -> Iterator[tuple[int, dict[str, Any]]]:
    """Yield the number of each line, from 1, and its row; nothing if the file does not exist.

    Raises: ResultsError if the file cannot be read or a line in it is damaged.
    """
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
