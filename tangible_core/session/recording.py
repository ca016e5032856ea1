"""What was felt, tick by tick, and the files it is kept in."""

import zlib
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import Any, Self
from zipfile import BadZipFile

import numpy as np
from jaxtyping import Float64, Int64

from ..data import TICK_COLUMNS, Record, TickFlag
from ..errors import DeviceError, OutputError
from ..files import atomic_write
from . import tick_file
from .tick_file import NOTHING_SAID, About

Vectors = Float64[np.ndarray, "n 3"]
Times = Float64[np.ndarray, "n"]
Bits = Int64[np.ndarray, "n"]

INTERRUPTED = "interrupted from the keyboard"
"""What a recording says that Ctrl-C ended."""
SUFFIXES = (".nc", ".npz", ".csv")
ARRAYS: dict[str, int | slice] = {
    "time_s": 0,
    "late_s": 1,
    "position_m": slice(2, 5),
    "velocity_m_per_s": slice(5, 8),
    "proxy_m": slice(8, 11),
    "force_n": slice(11, 14),
    "flags": 14,
    "buttons": 15,
}
"""Where each property of a recording, and array of an .npz, stands in a row of `TICK_COLUMNS`."""
NEEDED = ("time_s", "position_m", "velocity_m_per_s", "force_n")
"""What each recording has; the rest may be unknown:"""
UNKNOWN = {"late_s": 0.0, "proxy_x_m": np.nan, "proxy_y_m": np.nan, "proxy_z_m": np.nan, "flags": 0.0, "buttons": 0.0}


@dataclass(frozen=True, eq=False)
class Recording(Record):
    """What was felt, tick by tick, in the workspace frame: rows of `TICK_COLUMNS`.

    Raises: OutputError if the rows are no such table.
    """

    rows: Float64[np.ndarray, "n columns"]
    stopped: str = ""
    """Why it ended early; empty when the time was over."""
    about: About = NOTHING_SAID

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.rows.ndim != 2 or self.rows.shape[1] != len(TICK_COLUMNS):
            raise OutputError(f"a recording is (n, {len(TICK_COLUMNS)}), as TICK_COLUMNS, not {self.rows.shape}")

    @classmethod
    def of(cls, stopped: str = "", about: About | None = None, **arrays: np.ndarray) -> Self:
        """A recording of `ARRAYS` by name; those that are left out, but not `NEEDED`, were not known.

        Raises: OutputError if the arrays are not of one length, KeyError if a name is missing or unknown.
        """
        rows = _unknown(arrays["time_s"].size)
        for name in (*NEEDED, *(arrays.keys() - NEEDED)):
            part = rows[:, ARRAYS[name]]
            if arrays[name].shape != part.shape:
                raise OutputError(f"{name} is {arrays[name].shape}; with these times it is {part.shape}")
            part[:] = arrays[name]
        return cls(rows, stopped, about or NOTHING_SAID)

    @property
    def time_s(self) -> Times:
        """When each tick began, by the device's clock."""
        return self.rows[:, ARRAYS["time_s"]]

    @property
    def late_s(self) -> Times:
        """How late each tick began."""
        return self.rows[:, ARRAYS["late_s"]]

    @property
    def position_m(self) -> Vectors:
        """Where the tip was."""
        return self.rows[:, ARRAYS["position_m"]]

    @property
    def velocity_m_per_s(self) -> Vectors:
        """How fast the tip was, as the device said."""
        return self.rows[:, ARRAYS["velocity_m_per_s"]]

    @property
    def proxy_m(self) -> Vectors:
        """Where the proxy was, NaN where there is none."""
        return self.rows[:, ARRAYS["proxy_m"]]

    @property
    def force_n(self) -> Vectors:
        """What the device held from each tick to the next."""
        return self.rows[:, ARRAYS["force_n"]]

    @property
    def flags(self) -> Bits:
        """What happened, sums of `TickFlag`."""
        return self.rows[:, ARRAYS["flags"]].astype(np.int64)

    @property
    def buttons(self) -> Bits:
        """Buttons held, one bit each."""
        return self.rows[:, ARRAYS["buttons"]].astype(np.int64)

    @property
    def limited(self) -> int:
        """Ticks whose force was over the greatest allowed, and scaled down."""
        return int(np.count_nonzero(self.flags & TickFlag.FORCE_LIMITED))

    @property
    def not_finite(self) -> int:
        """Ticks whose force was NaN or infinite, and made zero."""
        return int(np.count_nonzero(self.flags & TickFlag.NOT_FINITE))

    @property
    def peak_force_n(self) -> float:
        """Greatest force; 0 for an empty recording."""
        return float(np.linalg.norm(self.force_n, axis=1).max(initial=0.0))

    @property
    def work_j(self) -> float:
        """Work done by the device on the hand: each force over the way to the next tick."""
        return float(np.sum(self.force_n[:-1] * np.diff(self.position_m, axis=0)))

    def figures(self) -> dict[str, float]:
        """The recording in numbers, by name."""
        force_n = np.linalg.norm(self.force_n, axis=1)
        touching_n = force_n[force_n > 0]
        return {
            "ticks": self.time_s.size,
            "seconds": float(np.ptp(self.time_s)) if self.time_s.size else 0.0,
            "contact_share": touching_n.size / max(1, force_n.size),
            "median_contact_force_n": float(np.median(touching_n)) if touching_n.size else 0.0,
            "peak_force_n": self.peak_force_n,
            "work_j": self.work_j,
            "limited": self.limited,
            "not_finite": self.not_finite,
        }

    def save(self, path: Path) -> None:
        """Write .nc (as a `Writer`), .npz (`numpy.load` reads it) or, the ticks alone, .csv; whole or not at all.

        Raises: OutputError for another suffix, or if the place cannot be written.
        """
        check_record_path(path)
        with atomic_write(path) as file:
            if path.suffix == ".nc":
                file.write(tick_file.header(self.about, self.stopped, len(self.rows)))
                file.write(tick_file.pack(self.rows))
            elif path.suffix == ".npz":
                arrays = {name: getattr(self, name) for name in ARRAYS}
                np.savez_compressed(file, stopped=self.stopped, **arrays, **asdict(self.about))
            else:
                np.savetxt(file, self.rows, "%.17g", ",", header=",".join(TICK_COLUMNS), comments="")

    @classmethod
    def load(cls, path: Path) -> Self:
        """A recording from any of the `SUFFIXES`; one that was cut off says so in `stopped`.

        It is all in memory then, half a gigabyte for an hour at 1 kHz.
        Raises: OutputError if it cannot be read or is none.
        """
        try:
            if path.suffix == ".nc":
                return cls(*tick_file.read(path))
            return cls.of(**_from_npz(path)) if path.suffix == ".npz" else cls(_from_csv(path))
        except OSError as error:
            raise OutputError(f"{path}: cannot be read: {error.strerror or error}") from error
        except (ValueError, LookupError, TypeError, EOFError, BadZipFile, zlib.error, OutputError) as error:
            raise OutputError(f"{path}: is no recording, or a damaged one ({error}); record it again") from error


def check_record_path(path: Path) -> None:
    """Raises: OutputError if a recording cannot have this name; ask before there is something to lose."""
    if path.suffix not in SUFFIXES:
        raise OutputError(f"{path}: a recording is written as .nc, .npz or .csv; change the end of the name")


def failure(recording: Recording) -> DeviceError:
    """What ended a recording early, as an error to raise once it is saved."""
    return DeviceError(f"stopped after {recording.time_s.size} ticks: {recording.stopped}")


def _from_npz(path: Path) -> dict[str, Any]:
    with path.open("rb") as file, np.load(file, allow_pickle=False) as archive:
        values: dict[str, Any] = dict(archive)
    about = About(**{each.name: str(values.get(each.name, "")) for each in fields(About)})
    arrays = {name: values[name] for name in (*NEEDED, *(values.keys() & ARRAYS.keys()))}
    return {**arrays, "stopped": str(values["stopped"]), "about": about}


def _from_csv(path: Path) -> Float64[np.ndarray, "n columns"]:
    header, *lines = path.read_text(encoding="utf-8").splitlines()
    names = header.split(",")
    if missing := [name for name in TICK_COLUMNS if name not in (*names, *UNKNOWN)]:
        raise ValueError(f"its first line names no {', '.join(missing)}")
    table = np.array([line.split(",") for line in lines], np.float64).reshape(-1, len(names))
    rows = _unknown(len(table))
    for name, values in zip(names, table.T, strict=True):
        if name in TICK_COLUMNS:
            rows[:, TICK_COLUMNS.index(name)] = values
    return rows


def _unknown(count: int) -> Float64[np.ndarray, "n columns"]:
    return np.tile([UNKNOWN.get(name, 0.0) for name in TICK_COLUMNS], (count, 1))
