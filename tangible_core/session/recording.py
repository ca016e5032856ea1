"""What was felt, tick by tick, and the files it is kept in."""

from dataclasses import dataclass
from os import PathLike
from typing import Self

import numpy as np
from jaxtyping import Float64, Int64

from ..data import TICK_COLUMNS, Record, TickFlag
from ..data.ticks import BEACON_SHIFT
from ..errors import DeviceError, OutputError
from ..files.paths import as_path
from . import recording_files
from .limited import changed_most, flag_counts
from .recording_files import RecordingContents
from .tick_arrays import ARRAYS, joined
from .tick_file import NOTHING_SAID, About

Vectors = Float64[np.ndarray, "n 3"]
Times = Float64[np.ndarray, "n"]
Bits = Int64[np.ndarray, "n"]

INTERRUPTED = "interrupted from the keyboard, or by a signal that asks a program to end"
"""What a recording says that Ctrl-C, SIGTERM or SIGHUP ended."""
STOPPED = "stopped by the program"
"""What one says that another thread ended."""


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
        """A recording of `ARRAYS` by name; some may be left out, as not known.

        Raises: as `joined`.
        """
        return cls(joined(arrays), stopped, about or NOTHING_SAID)

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
        """What happened, sums of `TickFlag`; above its bits stands the part of a beacon (`beacon`)."""
        return self.rows[:, ARRAYS["flags"]].astype(np.int64)

    @property
    def beacon(self) -> Bits:
        """The number of the part that a beacon pulled to, -1 in ticks without one."""
        flags = self.flags
        return np.where(flags & TickFlag.BEACON, flags >> BEACON_SHIFT, np.int64(-1))

    @property
    def buttons(self) -> Bits:
        """Buttons held, one bit each."""
        return self.rows[:, ARRAYS["buttons"]].astype(np.int64)

    @property
    def frame(self) -> Times:
        """The number of the frame that a surface which moves went to, NaN where it stood still."""
        return self.rows[:, ARRAYS["frame"]]

    @property
    def force_limited(self) -> int:
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

    @property
    def guard_sentence(self) -> str:
        """What the guard did to most of what was felt, and the cure; empty where it changed less."""
        return changed_most(flag_counts(self.flags))

    def __repr__(self) -> str:
        seconds = float(np.ptp(self.time_s)) if self.time_s.size else 0.0
        said = f"Recording of {seconds:.3g} s: {self.time_s.size} ticks, peak force {self.peak_force_n:.3g} N"
        return "\n".join(filter(None, [said, self.stopped and f"It ended early: {self.stopped}.", self.guard_sentence]))

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
            "force_limited": self.force_limited,
            "not_finite": self.not_finite,
        }

    def save(self, path: str | PathLike[str]) -> None:
        """Write .nc (as a `Writer`), .npz (`numpy.load` reads it) or, the ticks alone, .csv; whole or not at all.

        Raises: OutputError for another suffix, or if the place cannot be written.
        """
        recording_files.write(as_path(path), RecordingContents(self.rows, self.stopped, self.about))

    @classmethod
    def load(cls, path: str | PathLike[str]) -> Self:
        """A recording that was saved, or written by a `Writer`; one that was cut off says so in `stopped`.

        It is all in memory then, half a gigabyte for an hour at 1 kHz.
        Raises: OutputError if it cannot be read, is none, or holds more than `reading.MOST_BYTES`.
        """
        return cls(*recording_files.read(as_path(path)))


def failure(ticks: int, stopped: str) -> DeviceError:
    """What ended a session early, as an error to raise once all of it is saved and said."""
    return DeviceError(f"stopped after {ticks} ticks: {stopped}")
