"""What was felt, tick by tick, and the files it is kept in."""

import zlib
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Self
from zipfile import BadZipFile

import numpy as np
from jaxtyping import Float64

from ..data import Record
from ..errors import DeviceError, OutputError
from ..files import atomic_write

INTERRUPTED = "interrupted from the keyboard"
"""What a recording says that Ctrl-C ended."""
COLUMNS = ("time_s", *("x_m", "y_m", "z_m"), *("vx_m_per_s", "vy_m_per_s", "vz_m_per_s"), *("fx_n", "fy_n", "fz_n"))
"""Of a recording as CSV; a `mock` device can play it again."""


@dataclass(frozen=True, eq=False)
class Recording(Record):
    """What was felt, tick by tick, in the workspace frame.

    Raises: OutputError if the arrays are not of one length.
    """

    time_s: Float64[np.ndarray, "n"]
    position_m: Float64[np.ndarray, "n 3"]
    velocity_m_per_s: Float64[np.ndarray, "n 3"]
    force_n: Float64[np.ndarray, "n 3"]
    """What the device held from each tick to the next."""
    stopped: str = ""
    """Why it ended early; empty when the time was over."""
    not_finite: int = 0
    """Ticks whose force was NaN or infinite, and made zero."""
    limited: int = 0
    """Ticks whose force was over the device's maximum, and scaled down."""

    def __post_init__(self) -> None:
        super().__post_init__()
        vectors = (self.position_m, self.velocity_m_per_s, self.force_n)
        if self.time_s.ndim != 1 or any(each.shape != (self.time_s.size, 3) for each in vectors):
            raise OutputError(
                f"a recording has (n,) times and (n, 3) vectors, not {self.time_s.shape} and "
                f"{', '.join(str(each.shape) for each in vectors)}"
            )

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
        """Write all of it as .npz (`numpy.load` reads it), or the ticks alone as .csv; whole or not at all.

        Raises: OutputError for another suffix, or if the place cannot be written.
        """
        check_record_path(path)
        with atomic_write(path) as file:
            if path.suffix == ".npz":
                np.savez_compressed(file, **vars(self))
            else:
                table = np.column_stack([self.time_s, self.position_m, self.velocity_m_per_s, self.force_n])
                np.savetxt(file, table, "%.17g", ",", header=",".join(COLUMNS), comments="")

    @classmethod
    def load(cls, path: Path) -> Self:
        """A recording that `save` wrote. Raises: OutputError if it cannot be read or is none."""
        try:
            return cls(**_from_npz(path)) if path.suffix == ".npz" else cls(*_from_csv(path))
        except OSError as error:
            raise OutputError(f"{path}: cannot be read: {error.strerror or error}") from error
        except (ValueError, LookupError, TypeError, EOFError, BadZipFile, zlib.error, OutputError) as error:
            raise OutputError(f"{path}: is no recording, or a damaged one ({error}); record it again") from error


def check_record_path(path: Path) -> None:
    """Raises: OutputError if a recording cannot have this name; ask before there is something to lose."""
    if path.suffix not in (".npz", ".csv"):
        raise OutputError(f"{path}: a recording is written as .npz or .csv; change the end of the name")


def failure(recording: Recording) -> DeviceError:
    """What ended a recording early, as an error to raise once it is saved."""
    return DeviceError(f"stopped after {recording.time_s.size} ticks: {recording.stopped}")


def columns(table: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Time, position, velocity and force of rows as `COLUMNS`."""
    return table[:, 0], table[:, 1:4], table[:, 4:7], table[:, 7:10]


def _from_npz(path: Path) -> dict[str, Any]:
    with path.open("rb") as file, np.load(file, allow_pickle=False) as archive:
        fields: dict[str, Any] = dict(archive)
    scalars = {"stopped": str, "not_finite": int, "limited": int}
    return {name: scalars[name](value) if name in scalars else value for name, value in fields.items()}


def _from_csv(path: Path) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    header, *rows = path.read_text(encoding="utf-8").splitlines()
    if header != ",".join(COLUMNS):
        raise ValueError(f"its first line is not {','.join(COLUMNS)}")
    return columns(np.array([row.split(",") for row in rows], np.float64).reshape(-1, len(COLUMNS)))
