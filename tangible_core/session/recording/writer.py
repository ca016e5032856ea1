"""A recording that is written during the session: appended ticks can be read, however the program ends."""

from contextlib import suppress
from pathlib import Path
from types import TracebackType
from typing import Self, final

import numpy as np
from jaxtyping import Float64

from ...data import TICK_COLUMNS
from ...errors import OutputError
from ...files.writing import open_alone
from . import netcdf, tick_file
from .tick_file import NO_INFORMATION, About


@final
class Writer:
    """A writer of a growing recording, a `.nc` file; a second writer of the file, in any process, is refused.

    Ticks are written after the last one, and only then counted in the header: whenever a file is read, and whatever
    ends the program (a full disk, kill -9), the counted ticks are complete. Nothing is buffered in memory.
    Raises: OutputError if the place cannot be written, or has another writer.
    """

    def __init__(self, path: Path, about: About | None = None, *, private: bool = False) -> None:
        """private: a new file is for this user alone."""
        start = tick_file.header((about or NO_INFORMATION).with_versions())
        self.path = path
        self.ticks: int = 0
        """Number of ticks in the file."""
        self._stopped_at = start.index(tick_file.CUT_OFF.encode())
        self._ticks_at = len(start)
        self._file = open_alone(path, private=private)
        self._write(start, 0)

    @property
    def closed(self) -> bool:
        """True once nothing can be appended any more."""
        return self._file.closed

    def append(self, rows: Float64[np.ndarray, "n columns"]) -> None:
        """Append ticks, rows of `TICK_COLUMNS`: all of them or, if that fails, none.

        Raises: OutputError if they cannot be written, as on a full disk (the file is then closed, with the reason), or
        the writer is closed already, or the rows are not such a table.
        """
        if rows.ndim != 2 or rows.shape[1] != len(TICK_COLUMNS):
            raise OutputError(f"ticks have shape (n, {len(TICK_COLUMNS)}), as TICK_COLUMNS, not {rows.shape}")
        if self.closed:
            raise OutputError(f"{self.path}: the recording is closed; start another one")
        if self.ticks + len(rows) > netcdf.MOST_RECORDS:
            self.close("the recording is full")
            raise OutputError(f"{self.path}: is full, with {self.ticks} ticks; start another one")
        if len(rows):
            self._write(tick_file.pack(rows), self._ticks_at + self.ticks * tick_file.RECORD.itemsize)
            self._write(netcdf.integer(self.ticks + len(rows)), netcdf.COUNT_AT)
            self.ticks += len(rows)

    def close(self, stopped: str = "") -> None:
        """Write the reason of the end, "" if the time was over, and close the file; a second call does nothing."""
        if not self.closed:
            with self._file, suppress(OSError):  # if this cannot be written, the file has the reason CUT_OFF
                self._put(tick_file.pad_reason(stopped), self._stopped_at)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close(f"{kind.__name__}: {error}" if kind else "")

    def _write(self, data: bytes, at: int) -> None:
        try:
            self._put(data, at)
        except OSError as error:
            self.close(f"the recording ends early: {error.strerror}")
            raise OutputError(
                f"{self.path}: cannot be written: {error.strerror}; it holds {self.ticks} ticks; free some space"
            ) from error

    def _put(self, data: bytes, at: int) -> None:
        self._file.seek(at)
        while data:  # a disk that is nearly full takes a part, and fails only then
            data = data[self._file.write(data) :]
