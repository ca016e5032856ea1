"""The file of a recording: netCDF, a variable for each of TICK_COLUMNS, a record a tick (docs/how-to/recordings.md)."""

import platform
from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import asdict, dataclass, fields, replace
from datetime import UTC, datetime
from importlib.metadata import version
from pathlib import Path
from types import TracebackType
from typing import Any, Self, cast, final

import numpy as np
from jaxtyping import Float64

from ...data import TICK_COLUMNS, TickFlag
from ...data.ticks import BEACON_SHIFT
from ...errors import OutputError
from ...files.writing import open_alone
from . import netcdf
from .netcdf import Variable

# Frame of a surface at rest, in the file: the fill value, which netCDF's readers take for missing.
STILL = -1
# Reason of the end in a file that is not closed.
CUT_OFF = "cut off: the recorder was ended before it could close the file"
STOPPED_BYTES = 240  # bytes that are reserved in the header for the reason of the end, which is written last
FRAME = "metres; x right, y away from the user, z up; the origin is the centre of the picture on the base plane"
"""Description of the coordinates, an attribute of the file."""


@dataclass(frozen=True)
class About:
    """Information about the session of a recording; empty where unknown."""

    device: str = ""
    renderer: str = ""
    configuration: str = ""
    """The completed pipeline file, as YAML."""
    started: str = ""
    """Date and time, ISO 8601."""
    software: str = ""
    """Programs that wrote the recording, with versions."""
    parts: str = ""
    """Names of the surface's parts, a JSON object from number to name; in a kiosk, a line for each scene, empty if it
    has no names."""
    materials: str = ""
    """Names of the surface's materials in the same form, by the number of the part or segment made of them."""

    def with_versions(self) -> Self:
        """Return a copy with date and versions filled in."""
        versions = [f"{name} {version(name)}" for name in ("tangible-images", "numpy")]
        software = ", ".join([*versions, f"Python {platform.python_version()}"])
        now = datetime.now(UTC).isoformat(timespec="seconds")
        return replace(self, started=self.started or now, software=self.software or software)


NO_INFORMATION = About()


def _variables() -> Iterator[Variable]:
    yield _variable(">f8", "s", "when the tick began, by the device's clock")
    yield _variable(">f4", "s", "how late it began")
    for dtype, units, what in (
        (">f8", "m", "position of the tip"),
        (">f8", "m s-1", "velocity of the tip"),
        (">f4", "m", "position of the proxy, NaN where there is none"),
        (">f4", "N", "force on the hand that the device was given"),
    ):
        yield from (_variable(dtype, units, f"{axis} of the {what}") for axis in "xyz")
    flags = np.array(list(TickFlag), ">i4"), " ".join(str(flag.name).lower() for flag in TickFlag)
    what = f"what happened in the tick; from bit {BEACON_SHIFT} on the number of the part that a beacon pulls to"
    yield _variable(">i4", "1", what, flag_masks=flags[0], flag_meanings=flags[1])
    yield _variable(">i4", "1", "buttons held, one bit each")
    yield _variable(">i4", "1", "frame that a surface which moves went to", _FillValue=np.array([STILL], ">i4"))


def _variable(dtype: str, units: str, long_name: str, **more: str | np.ndarray) -> Variable:
    return Variable(dtype, {"long_name": long_name, "units": units, **more})


VARIABLES = dict(zip(TICK_COLUMNS, _variables(), strict=True))
"""Variables by column. Inputs of a force law are exact: rounded by a nanometre, a proxy may take another way. Its
outputs are float32: within 4 nm of a proxy under 0.125 m from the centre, and 0.3 uN of a force under 8 N."""
RECORD = np.dtype([(name, variable.dtype) for name, variable in VARIABLES.items()])


def header(about: About, stopped: str = CUT_OFF, ticks: int = 0) -> bytes:
    """Return the bytes of a file before its ticks, which follow in the form of `pack`."""
    texts = {name: text for name, text in asdict(about).items() if text}
    attributes = {"stopped": pad_reason(stopped).decode(), "frame": FRAME, **texts}
    return netcdf.header("tick", attributes, VARIABLES, ticks)


def pad_reason(stopped: str) -> bytes:
    """Return the reason of an end in UTF-8, cut and padded to STOPPED_BYTES."""
    cut = stopped.encode()[:STOPPED_BYTES].decode(errors="ignore")
    return cut.encode().ljust(STOPPED_BYTES)


def pack(rows: Float64[np.ndarray, "n columns"]) -> bytes:
    """Return rows of `TICK_COLUMNS` as records; values beyond float32 become infinite."""
    records = np.empty(len(rows), RECORD)
    with np.errstate(over="ignore"):
        for name, values in zip(TICK_COLUMNS, rows.T, strict=True):
            records[name] = values if name != "frame" else np.where((values >= 0) & (values < 2**31), values, STILL)
    return records.tobytes()


def read(path: Path) -> tuple[Float64[np.ndarray, "n columns"], str, About]:
    """Read rows of `TICK_COLUMNS`, the reason of the end, and the information about the session."""
    from scipy.io import netcdf_file  # pyright: ignore[reportMissingTypeStubs]

    with netcdf_file(path, "r", mmap=True) as netcdf:
        file = cast(Any, netcdf)
        rows = unknown_rows(file.variables["time_s"].shape[0])
        for i, name in enumerate(TICK_COLUMNS):
            if name in file.variables or name != "frame":  # older recordings have no frame
                rows[:, i] = file.variables[name][:]
        frame = rows[:, ARRAYS["frame"]]
        frame[frame == STILL] = np.nan
        about = {field.name: _text(file, field.name) for field in fields(About)}
        return rows, _text(file, "stopped"), About(**about)


def _text(file: Any, name: str) -> str:
    return getattr(file, name, b"").decode().rstrip(" ")


ARRAYS: dict[str, int | slice] = {
    "time_s": 0,
    "late_s": 1,
    "position_m": slice(2, 5),
    "velocity_m_per_s": slice(5, 8),
    "proxy_m": slice(8, 11),
    "force_n": slice(11, 14),
    "flags": 14,
    "buttons": 15,
    "frame": 16,
}
"""Columns in a row of `TICK_COLUMNS` of each property of a recording and array of an .npz."""
# Arrays that every recording has; the others may be unknown.
NEEDED = ("time_s", "position_m", "velocity_m_per_s", "force_n")
UNKNOWN = {
    "late_s": 0.0,
    "proxy_x_m": np.nan,
    "proxy_y_m": np.nan,
    "proxy_z_m": np.nan,
    "flags": 0.0,
    "buttons": 0.0,
    "frame": np.nan,
}


def unknown_rows(count: int) -> Float64[np.ndarray, "n columns"]:
    """Return rows in which nothing is known."""
    return np.tile([UNKNOWN.get(name, 0.0) for name in TICK_COLUMNS], (count, 1))


def join_arrays(arrays: Mapping[str, np.ndarray]) -> Float64[np.ndarray, "n columns"]:
    """Join `ARRAYS`, by name, to rows of `TICK_COLUMNS`; arrays that are not `NEEDED` may be left out as unknown."""
    rows = unknown_rows(arrays["time_s"].size)
    for name in (*NEEDED, *(arrays.keys() - NEEDED)):
        part = rows[:, ARRAYS[name]]
        if arrays[name].dtype.kind not in "biuf":
            raise OutputError(f"{name} holds {arrays[name].dtype.name}, not numbers")
        if arrays[name].shape != part.shape:
            raise OutputError(f"{name} has shape {arrays[name].shape}; with these times it must be {part.shape}")
        part[:] = arrays[name]
    return rows


@final
class Writer:
    """A writer of a growing recording, a `.nc` file; a second writer of the file, in any process, is refused.

    Ticks are written after the last one, and only then counted in the header: whenever a file is read, and whatever
    ends the program (a full disk, kill -9), the counted ticks are complete. Nothing is buffered in memory.
    Raises: OutputError if the place cannot be written, or has another writer.
    """

    def __init__(self, path: Path, about: About | None = None, *, private: bool = False) -> None:
        """private: a new file is for this user alone."""
        start = header((about or NO_INFORMATION).with_versions())
        self.path = path
        self.ticks: int = 0
        """Number of ticks in the file."""
        self._stopped_at = start.index(CUT_OFF.encode())
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
        if self.ticks + len(rows) > netcdf.MAX_RECORDS:
            self.close("the recording is full")
            raise OutputError(f"{self.path}: is full, with {self.ticks} ticks; start another one")
        if len(rows):
            self._write(pack(rows), self._ticks_at + self.ticks * RECORD.itemsize)
            self._write(netcdf.integer(self.ticks + len(rows)), netcdf.COUNT_AT)
            self.ticks += len(rows)

    def close(self, stopped: str = "") -> None:
        """Write the reason of the end, "" if the time was over, and close the file; a second call does nothing."""
        if not self.closed:
            with self._file, suppress(OSError):  # if this cannot be written, the file has the reason CUT_OFF
                self._put(pad_reason(stopped), self._stopped_at)

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
