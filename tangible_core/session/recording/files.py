"""Recordings on disk: .nc, .npz and .csv."""

from collections.abc import Callable
from dataclasses import asdict, fields
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from jaxtyping import Float64

from ...data import TICK_COLUMNS
from ...errors import OutputError, shown
from ...files.arrays import Archive
from ...files.reading import check_file
from ...files.tables import read_table
from ...files.writing import atomic_write
from . import tick_file
from .tick_file import ARRAYS, NEEDED, NO_INFORMATION, UNKNOWN, About, join_arrays, unknown_rows

SUFFIXES = (".nc", ".npz", ".csv")
NPZ_NAMES = frozenset(("stopped", *ARRAYS, *(field.name for field in fields(About))))


class RecordingContents(NamedTuple):
    """The contents of a file: rows of `TICK_COLUMNS`, the reason of an early end, and information about the session."""

    rows: Float64[np.ndarray, "n columns"]
    stopped: str = ""
    about: About = NO_INFORMATION


def check_record_path(path: Path, endless: bool = False) -> None:
    """Check the name of a recording before it begins. Raises: OutputError for a suffix that it cannot have."""
    if path.suffix not in SUFFIXES:
        raise OutputError(f"{path}: a recording is written as .nc, .npz or .csv; change the end of the name")
    if endless and path.suffix != ".nc":
        raise OutputError(
            f"{path}: is written only at the end of a session; a session without end is recorded as .nc, which grows: "
            "change the end of the name"
        )


def write(path: Path, contents: RecordingContents) -> None:
    """Write a whole file or nothing. Raises: OutputError for another suffix, or if the place cannot be written."""
    check_record_path(path)
    with atomic_write(path) as file:
        if path.suffix == ".nc":
            file.write(tick_file.header(contents.about, contents.stopped, len(contents.rows)))
            file.write(tick_file.pack(contents.rows))
        elif path.suffix == ".npz":
            arrays = {name: contents.rows[:, at] for name, at in ARRAYS.items()}
            bits = {name: arrays[name].astype(np.int64) for name in ("flags", "buttons")}
            np.savez_compressed(file, stopped=contents.stopped, **arrays | bits, **asdict(contents.about))
        else:
            np.savetxt(file, contents.rows, "%.17g", ",", header=",".join(TICK_COLUMNS), comments="")


def read(path: Path) -> RecordingContents:
    """Read a recording. Raises: OutputError if the file cannot be read or is not a recording."""
    check_record_path(path)
    try:
        check_file(path)
        with np.errstate(all="ignore"):  # NaN and infinity stay as they are
            contents = READERS[path.suffix](path)
        for name in ("flags", "buttons"):
            if not (np.abs(contents.rows[:, ARRAYS[name]]) < 2**31).all():
                raise ValueError(f"its {name} do not all fit into 32 bits")
    except OSError as error:
        missing_file = isinstance(error, FileNotFoundError)
        why = "there is no such file" if missing_file else f"cannot be read: {error.strerror or error}"
        raise OutputError(f"{path}: {why}") from error
    except ImportError:  # a package is missing, which is not the file's fault
        raise
    except Exception as error:  # a damaged file can provoke any
        why = shown(str(error), 200)
        raise OutputError(f"{path}: is not a recording, or a damaged one ({why}); record it again") from error
    return contents


def _from_npz(path: Path) -> RecordingContents:
    with path.open("rb") as file:
        archive = Archive(file)
        values: dict[str, Any] = archive.read([name for name in archive.names if name in NPZ_NAMES])
    about = About(**{field.name: str(values.get(field.name, "")) for field in fields(About)})
    if missing := [name for name in (*NEEDED, "stopped") if name not in values]:
        raise ValueError(f"it holds no {', '.join(missing)}")
    rows = join_arrays({name: values[name] for name in ARRAYS if name in values})
    return RecordingContents(rows, str(values["stopped"]), about)


def _from_csv(path: Path) -> RecordingContents:
    names, lines = read_table(path)
    if missing := [name for name in TICK_COLUMNS if name not in (*names, *UNKNOWN)]:
        raise ValueError(f"its first line has no {', '.join(missing)}")
    table = np.array([_numbers(number, names, cells) for number, cells in lines], np.float64).reshape(-1, len(names))
    rows = unknown_rows(len(table))
    for name, values in zip(names, table.T, strict=True):
        if name in TICK_COLUMNS:
            rows[:, TICK_COLUMNS.index(name)] = values
    return RecordingContents(rows)


def _numbers(line: int, names: list[str], cells: dict[str, str]) -> list[float]:
    values: list[float] = []
    for name in names:
        try:
            values.append(float(cells.get(name, "")))
        except ValueError as error:
            raise ValueError(f"in line {line}, {name} is not a number: {error}") from error
    return values


READERS: dict[str, Callable[[Path], RecordingContents]] = {
    ".nc": lambda path: RecordingContents(*tick_file.read(path)),
    ".npz": _from_npz,
    ".csv": _from_csv,
}
