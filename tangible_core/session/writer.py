"""Ticks to a file while they happen: what was appended can be read, however the program ends."""

from contextlib import suppress
from pathlib import Path
from types import TracebackType
from typing import Self, final

import numpy as np
from jaxtyping import Float64

from ..data import TICK_COLUMNS
from ..errors import OutputError
from ..files.writing import open_alone
from . import netcdf, tick_file
from .tick_file import NOTHING_SAID, About


@final
class Writer:
    """A recording as it grows, a `.nc` file. One writer a file: another one, in any process, is refused.

    Ticks are written behind the last one, and only then counted in the header. Whoever reads, and whatever ends the
    program (a full disk, kill -9), the counted ticks are whole. Nothing is held back in memory.
    Raises: OutputError if the place cannot be written, or another writer is at it.
    """

    def __init__(self, path: Path, about: About | None = None) -> None:
        start = tick_file.header((about or NOTHING_SAID).stamped())
        self.path = path
        self.ticks = 0
        """So many are in the file."""
        self._stopped_at = start.index(tick_file.CUT_OFF.encode())
        self._ticks_at = len(start)
        self._file = open_alone(path)
        self._write(start, 0)

    @property
    def closed(self) -> bool:
        """Whether nothing more can be appended."""
        return self._file.closed

    def append(self, rows: Float64[np.ndarray, "n columns"]) -> None:
        """Keep these ticks, rows of `TICK_COLUMNS`; all of them or, when that fails, none.

        Raises: OutputError if they cannot be written, as on a full disk (the file is then closed, and says so), or the
        writer is closed already, or the rows are no such table.
        """
        if rows.ndim != 2 or rows.shape[1] != len(TICK_COLUMNS):
            raise OutputError(f"ticks are (n, {len(TICK_COLUMNS)}), a column each of TICK_COLUMNS, not {rows.shape}")
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
        """Say why it ended, empty when the time was over, and let go of the file; a second call does nothing."""
        if not self.closed:
            with self._file, suppress(OSError):  # it says that it was cut off, if this cannot be said
                self._put(tick_file.filled(stopped), self._stopped_at)

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
        while data:  # a disk that is nearly full takes a part, and only then says so
            data = data[self._file.write(data) :]
