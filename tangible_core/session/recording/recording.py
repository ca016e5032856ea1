"""A recording of a session, tick by tick."""

from collections.abc import Mapping
from dataclasses import dataclass
from importlib import import_module
from os import PathLike
from typing import Any, Self

import numpy as np
from jaxtyping import Float64, Int64

from ...data import TICK_COLUMNS, Record, TickFlag
from ...data.arguments import named_fields
from ...data.ticks import BEACON_SHIFT
from ...errors import DeviceError, OutputError
from ...files.paths import as_path
from . import files
from .files import RecordingContents
from .tick_file import ARRAYS, NO_INFORMATION, About, join_arrays

Vectors = Float64[np.ndarray, "n 3"]
Times = Float64[np.ndarray, "n"]
Bits = Int64[np.ndarray, "n"]

INTERRUPTED = "interrupted from the keyboard, or by a signal that asks a program to end"
"""Reason of a recording that Ctrl-C, SIGTERM or SIGHUP ended."""
STOPPED = "stopped by the program"
"""Reason of a recording that another thread ended."""


MOST = 0.5  # share of the ticks in contact above which a limit is reported

SENTENCES = {
    TickFlag.STIFFNESS_LIMITED: "the force was scaled down, because the force law is stiffer than this device and loop "
    "can render stably; use a lower `render.stiffness_n_per_m` or softer materials",
    TickFlag.FORCE_LIMITED: "the force exceeded the greatest allowed force and was limited to it; press less, or "
    "use a lower `workspace.relief_m` or a lower stiffness",
    TickFlag.SLEW_LIMITED: "the force was delayed, because it changed by more than `safety.max_step_n` in a tick; "
    "use a smoother or lower relief (`workspace.smooth_m`, `workspace.relief_m`) or a softer force law",
    TickFlag.DAMPED: "the hand was damped, because the force law gave it more energy than it took; use a softer force "
    "law, less texture, or `safety.coupling: auto`",
    TickFlag.NOT_FINITE: "the force was set to zero, because the force law or the device gave a value that is not a "
    "number; the force law or the driver is at fault",
    TickFlag.STALE: "the force was set to zero, because no new position came in time; check the device's "
    "connection, and whether the force law takes longer than a tick",
}


def guard_summary(flagged: Mapping[str, int]) -> str:
    """Return a sentence about the limit that changed most ticks in contact, and the cure; empty if there is none.

    flagged: number of ticks with each flag, by its name, as in `ServoReport.flagged`. Fading in is not reported.

    >>> guard_summary({"TOUCHING": 1000, "STIFFNESS_LIMITED": 499})
    ''
    """
    by_name = {flag.name or "": flag for flag in SENTENCES}
    contacts = sum(flagged.get(name, 0) for name in ("TOUCHING", "NOT_FINITE", "STALE"))  # no tick has two of these
    ticks, name = max((flagged.get(name, 0), name) for name in by_name)
    if ticks <= MOST * contacts:
        return ""
    share = f"{100 * ticks / contacts:.0f} %"
    return f"In {share} of the ticks in contact {SENTENCES[by_name[name]]} (`tangible preflight` shows what fits)."


def flag_counts(flags: Int64[np.ndarray, "n"]) -> Mapping[str, int]:
    """Count the ticks with each flag, by its name, without flags that no tick has."""
    counts = {flag.name or "": int(np.count_nonzero(flags & flag)) for flag in TickFlag}
    return {name: count for name, count in counts.items() if count}


@named_fields
@dataclass(frozen=True, eq=False)
class Recording(Record):
    """A session tick by tick, in the workspace frame: rows of `TICK_COLUMNS`.

    `load` and `save` take .nc, .npz and .csv; `to_pandas` gives a table with a column for each quantity. Each property
    is one row per tick, in the unit of its name. `device: replay` moves a hand along a recording again.

    >>> import numpy as np
    >>> Recording(np.zeros((1000, len(TICK_COLUMNS)))).force_n.shape
    (1000, 3)

    Raises: OutputError if the rows are not such a table.
    """

    rows: Float64[np.ndarray, "n columns"]
    stopped: str = ""
    """Reason of an early end; empty if the time was over."""
    about: About = NO_INFORMATION

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.rows.ndim != 2 or self.rows.shape[1] != len(TICK_COLUMNS):
            raise OutputError(f"a recording has shape (n, {len(TICK_COLUMNS)}), as TICK_COLUMNS, not {self.rows.shape}")

    @classmethod
    def of(cls, stopped: str = "", about: About | None = None, **arrays: np.ndarray) -> Self:
        """Return a recording of `ARRAYS` by name; unknown ones may be left out. Raises: as `join_arrays`."""
        return cls(join_arrays(arrays), stopped, about or NO_INFORMATION)

    @property
    def time_s(self) -> Times:
        """The time at which each tick began, by the device's clock."""
        return self.rows[:, ARRAYS["time_s"]]

    @property
    def late_s(self) -> Times:
        """The lateness of each tick."""
        return self.rows[:, ARRAYS["late_s"]]

    @property
    def position_m(self) -> Vectors:
        """The position of the tip."""
        return self.rows[:, ARRAYS["position_m"]]

    @property
    def velocity_m_per_s(self) -> Vectors:
        """The velocity of the tip, as measured by the device."""
        return self.rows[:, ARRAYS["velocity_m_per_s"]]

    @property
    def proxy_m(self) -> Vectors:
        """The position of the proxy; NaN where there is none."""
        return self.rows[:, ARRAYS["proxy_m"]]

    @property
    def force_n(self) -> Vectors:
        """The force that the device held from each tick to the next."""
        return self.rows[:, ARRAYS["force_n"]]

    @property
    def flags(self) -> Bits:
        """Sums of `TickFlag`; the bits above it hold the part of a beacon (`beacon`)."""
        return self.rows[:, ARRAYS["flags"]].astype(np.int64)

    @property
    def beacon(self) -> Bits:
        """The number of the part that a beacon pulled to; -1 in ticks without a beacon."""
        flags = self.flags
        return np.where(flags & TickFlag.BEACON, flags >> BEACON_SHIFT, np.int64(-1))

    @property
    def buttons(self) -> Bits:
        """Buttons held, one bit each."""
        return self.rows[:, ARRAYS["buttons"]].astype(np.int64)

    @property
    def frame(self) -> Times:
        """The number of the frame to which a moving surface went; NaN if it stood still."""
        return self.rows[:, ARRAYS["frame"]]

    @property
    def force_limited(self) -> int:
        """The number of ticks whose force was scaled down to the greatest allowed."""
        return int(np.count_nonzero(self.flags & TickFlag.FORCE_LIMITED))

    @property
    def not_finite(self) -> int:
        """The number of ticks whose force was NaN or infinite, and set to zero."""
        return int(np.count_nonzero(self.flags & TickFlag.NOT_FINITE))

    @property
    def peak_force_n(self) -> float:
        """The greatest force; 0 for an empty recording."""
        return float(np.linalg.norm(self.force_n, axis=1).max(initial=0.0))

    @property
    def work_j(self) -> float:
        """The work of the device on the hand: each force over the way to the next tick."""
        return float(np.sum(self.force_n[:-1] * np.diff(self.position_m, axis=0)))

    @property
    def guard_sentence(self) -> str:
        """A sentence about the limit that changed most ticks in contact, with the cure; empty if there is none."""
        return guard_summary(flag_counts(self.flags))

    def __repr__(self) -> str:
        seconds = float(np.ptp(self.time_s)) if self.time_s.size else 0.0
        text = f"Recording of {seconds:.3g} s: {self.time_s.size} ticks, peak force {self.peak_force_n:.3g} N"
        return "\n".join(filter(None, [text, self.stopped and f"It ended early: {self.stopped}.", self.guard_sentence]))

    def figures(self) -> dict[str, float]:
        """Return the figures of the recording, by name."""
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

    def to_pandas(self) -> Any:
        """Return a pandas.DataFrame with a row for each tick: `TICK_COLUMNS`, and the part of the beacon, else -1.

        Raises: OutputError without pandas.
        """
        try:
            pandas: Any = import_module("pandas")
        except ImportError as error:
            raise OutputError("a table of ticks needs pandas: pip install pandas") from error
        whole = {"flags": self.flags & ((1 << BEACON_SHIFT) - 1), "buttons": self.buttons, "beacon": self.beacon}
        return pandas.DataFrame(self.rows, columns=TICK_COLUMNS).assign(**whole)

    def save(self, path: str | PathLike[str]) -> None:
        """Write .nc (as a `Writer`), .npz (for `numpy.load`) or .csv (the ticks alone); the whole file or nothing.

        Raises: OutputError for another suffix, or if the place cannot be written.
        """
        files.write(as_path(path), RecordingContents(self.rows, self.stopped, self.about))

    @classmethod
    def load(cls, path: str | PathLike[str]) -> Self:
        """Load a recording that was saved, or written by a `Writer`; `stopped` notes if it was cut off.

        It needs memory for all ticks: half a gigabyte for an hour at 1 kHz.
        Raises: OutputError if the file cannot be read, is not a recording, or is larger than `reading.MAX_BYTES`.
        """
        return cls(*files.read(as_path(path)))


def failure(ticks: int, stopped: str) -> DeviceError:
    """Return an error for an early end, to raise once everything is saved and reported."""
    return DeviceError(f"stopped after {ticks} ticks: {stopped}")
