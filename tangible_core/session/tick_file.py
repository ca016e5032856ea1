"""The file of a recording: netCDF, a variable for each of TICK_COLUMNS, a record a tick (docs/recordings.md)."""

import platform
from collections.abc import Iterator
from dataclasses import asdict, dataclass, fields, replace
from datetime import UTC, datetime
from importlib.metadata import version
from pathlib import Path
from typing import Any, Self, cast

import numpy as np
from jaxtyping import Float64

from ..data import TICK_COLUMNS, TickFlag
from ..data.ticks import BEACON_SHIFT
from . import netcdf
from .netcdf import Variable
from .tick_arrays import ARRAYS, unknown

STILL = -1
"""In the file, the frame of a surface that stands still: netCDF's readers take what a variable fills in for missing."""
CUT_OFF = "cut off: the recorder was ended before it could close the file"
"""What a file says until it is closed."""
STOPPED_BYTES = 240
"""Kept free in the header for why it ended, so that it can be said once that is known."""
FRAME = "metres; x right, y away from the user, z up; the origin is the centre of the picture on the base plane"


@dataclass(frozen=True)
class About:
    """What a recording is of; empty where nobody said."""

    device: str = ""
    renderer: str = ""
    configuration: str = ""
    """The completed pipeline file, as YAML."""
    started: str = ""
    """Date and time, ISO 8601."""
    software: str = ""
    """What wrote it, with versions."""
    parts: str = ""
    """Names of the surface's parts, a JSON object from number to name; of scenes felt in turn, a line each, which is
    empty for one without names."""
    materials: str = ""
    """Names of the surface's materials in the same form, by the number of the part or segment that is made of it."""

    def stamped(self) -> Self:
        """With date and versions, where they are not said."""
        versions = [f"{name} {version(name)}" for name in ("tangible-images", "numpy")]
        software = ", ".join([*versions, f"Python {platform.python_version()}"])
        now = datetime.now(UTC).isoformat(timespec="seconds")
        return replace(self, started=self.started or now, software=self.software or software)


NOTHING_SAID = About()


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
    flags = np.array(list(TickFlag), ">i4"), " ".join(str(each.name).lower() for each in TickFlag)
    what = f"what happened in the tick; from bit {BEACON_SHIFT} on the number of the part that a beacon pulls to"
    yield _variable(">i4", "1", what, flag_masks=flags[0], flag_meanings=flags[1])
    yield _variable(">i4", "1", "buttons held, one bit each")
    yield _variable(">i4", "1", "frame that a surface which moves went to", _FillValue=np.array([STILL], ">i4"))


def _variable(dtype: str, units: str, long_name: str, **more: str | np.ndarray) -> Variable:
    return Variable(dtype, {"long_name": long_name, "units": units, **more})


VARIABLES = dict(zip(TICK_COLUMNS, _variables(), strict=True))
"""What a law is given is exact: rounded by a nanometre, a proxy may take another way. What it gave is float32, within
4 nm of a proxy under 0.125 m from the centre and 0.3 uN of a force under 8 N."""
RECORD = np.dtype([(name, variable.dtype) for name, variable in VARIABLES.items()])
"""A tick, 96 bytes."""


def header(about: About, stopped: str = CUT_OFF, ticks: int = 0) -> bytes:
    """The file up to its ticks, which follow as `pack` makes them."""
    said = {name: text for name, text in asdict(about).items() if text}
    attributes = {"stopped": filled(stopped).decode(), "frame": FRAME, **said}
    return netcdf.header("tick", attributes, VARIABLES, ticks)


def filled(stopped: str) -> bytes:
    """In UTF-8, cut and filled to what is kept free for it."""
    cut = stopped.encode()[:STOPPED_BYTES].decode(errors="ignore")
    return cut.encode().ljust(STOPPED_BYTES)


def pack(rows: Float64[np.ndarray, "n columns"]) -> bytes:
    """Rows of `TICK_COLUMNS` as records; what float32 cannot hold becomes infinite."""
    records = np.empty(len(rows), RECORD)
    with np.errstate(over="ignore"):
        for name, values in zip(TICK_COLUMNS, rows.T, strict=True):
            records[name] = values if name != "frame" else np.where((values >= 0) & (values < 2**31), values, STILL)
    return records.tobytes()


def read(path: Path) -> tuple[Float64[np.ndarray, "n columns"], str, About]:
    """Rows of `TICK_COLUMNS`, why it ended, and what it is of.

    Raises: OSError, and what scipy raises for a file that is damaged or something else.
    """
    from scipy.io import netcdf_file  # pyright: ignore[reportMissingTypeStubs]

    with netcdf_file(path, "r", mmap=True) as opened:
        file = cast(Any, opened)
        rows = unknown(file.variables["time_s"].shape[0])
        for i, name in enumerate(TICK_COLUMNS):
            if name in file.variables or name != "frame":  # which older recordings have not
                rows[:, i] = file.variables[name][:]
        frame = rows[:, ARRAYS["frame"]]
        frame[frame == STILL] = np.nan
        about = {each.name: _text(file, each.name) for each in fields(About)}
        return rows, _text(file, "stopped"), About(**about)


def _text(file: Any, name: str) -> str:
    return getattr(file, name, b"").decode().rstrip(" ")
