"""Recordings on disk: .nc, .npz and .csv."""

from dataclasses import asdict, fields
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from jaxtyping import Float64

from ..data import TICK_COLUMNS
from ..errors import OutputError, shown
from ..files.arrays import Archive
from ..files.reading import check_file, read_bytes
from ..files.writing import atomic_write
from . import tick_file
from .tick_arrays import ARRAYS, NEEDED, UNKNOWN, joined, unknown
from .tick_file import NOTHING_SAID, About

SUFFIXES = (".nc", ".npz", ".csv")
NPZ_NAMES = frozenset(("stopped", *ARRAYS, *(each.name for each in fields(About))))
"""What is read of an .npz."""


class RecordingContents(NamedTuple):
    """What a file holds: rows of `TICK_COLUMNS`, why the recording ended, and what it is of."""

    rows: Float64[np.ndarray, "n columns"]
    stopped: str = ""
    about: About = NOTHING_SAID


def check_record_path(path: Path, endless: bool = False) -> None:
    """Raises: OutputError if a recording (or one without end) cannot have this name; ask before there is one."""
    if path.suffix not in SUFFIXES:
        raise OutputError(f"{path}: a recording is written as .nc, .npz or .csv; change the end of the name")
    if endless and path.suffix != ".nc":
        raise OutputError(
            f"{path}: is made at the end, of all that was felt; a session without end is recorded as .nc, which grows: "
            "change the end of the name"
        )


def write(path: Path, kept: RecordingContents) -> None:
    """Write it whole or not at all. Raises: OutputError for another suffix, or if the place cannot be written."""
    check_record_path(path)
    with atomic_write(path) as file:
        if path.suffix == ".nc":
            file.write(tick_file.header(kept.about, kept.stopped, len(kept.rows)))
            file.write(tick_file.pack(kept.rows))
        elif path.suffix == ".npz":
            arrays = {name: kept.rows[:, at] for name, at in ARRAYS.items()}
            bits = {name: arrays[name].astype(np.int64) for name in ("flags", "buttons")}
            np.savez_compressed(file, stopped=kept.stopped, **arrays | bits, **asdict(kept.about))
        else:
            np.savetxt(file, kept.rows, "%.17g", ",", header=",".join(TICK_COLUMNS), comments="")


def read(path: Path) -> RecordingContents:
    """Raises: OutputError if it cannot be read or is no recording."""
    check_record_path(path)
    try:
        check_file(path)
        with np.errstate(all="ignore"):  # what no number is stays none
            kept = READERS[path.suffix](path)
        _check_bits(kept.rows)
    except OSError as error:
        raise OutputError(f"{path}: cannot be read: {error.strerror or error}") from error
    except Exception as error:  # a damaged file can provoke any
        why = shown(str(error), 200)
        raise OutputError(f"{path}: is no recording, or a damaged one ({why}); record it again") from error
    return kept


def _check_bits(rows: Float64[np.ndarray, "n columns"]) -> None:
    """Raises: ValueError if flags or buttons are none that a whole number of the format can hold."""
    for name in ("flags", "buttons"):
        if not (np.abs(rows[:, ARRAYS[name]]) < 2**31).all():
            raise ValueError(f"its {name} do not all fit into 32 bits")


def _from_nc(path: Path) -> RecordingContents:
    return RecordingContents(*tick_file.read(path))


def _from_npz(path: Path) -> RecordingContents:
    with path.open("rb") as file:
        archive = Archive(file)
        values: dict[str, Any] = archive.read([name for name in archive.names if name in NPZ_NAMES])
    about = About(**{each.name: str(values.get(each.name, "")) for each in fields(About)})
    if missing := [name for name in (*NEEDED, "stopped") if name not in values]:
        raise ValueError(f"it holds no {', '.join(missing)}")
    rows = joined({name: values[name] for name in ARRAYS if name in values})
    return RecordingContents(rows, str(values["stopped"]), about)


def _from_csv(path: Path) -> RecordingContents:
    header, *lines = read_bytes(path).decode("utf-8-sig").splitlines()
    names = header.split(",")
    if missing := [name for name in TICK_COLUMNS if name not in (*names, *UNKNOWN)]:
        raise ValueError(f"its first line names no {', '.join(missing)}")
    table = np.array([line.split(",") for line in lines], np.float64).reshape(-1, len(names))
    rows = unknown(len(table))
    for name, values in zip(names, table.T, strict=True):
        if name in TICK_COLUMNS:
            rows[:, TICK_COLUMNS.index(name)] = values
    return RecordingContents(rows)


READERS = {".nc": _from_nc, ".npz": _from_npz, ".csv": _from_csv}
