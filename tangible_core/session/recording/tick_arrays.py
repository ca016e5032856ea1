"""The columns of ticks, grouped into arrays: time, position, force and so on."""

from collections.abc import Mapping

import numpy as np
from jaxtyping import Float64

from ...data import TICK_COLUMNS
from ...errors import OutputError

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
NEEDED = ("time_s", "position_m", "velocity_m_per_s", "force_n")
"""Arrays that every recording has; the others may be unknown."""
UNKNOWN = {
    "late_s": 0.0,
    "proxy_x_m": np.nan,
    "proxy_y_m": np.nan,
    "proxy_z_m": np.nan,
    "flags": 0.0,
    "buttons": 0.0,
    "frame": np.nan,
}
"""Values of columns that are not known."""


def unknown_rows(count: int) -> Float64[np.ndarray, "n columns"]:
    """Return rows in which nothing is known."""
    return np.tile([UNKNOWN.get(name, 0.0) for name in TICK_COLUMNS], (count, 1))


def join_arrays(arrays: Mapping[str, np.ndarray]) -> Float64[np.ndarray, "n columns"]:
    """Join `ARRAYS`, by name, to rows of `TICK_COLUMNS`; arrays that are not `NEEDED` may be left out as unknown.

    Raises: OutputError if the arrays differ in length, KeyError if a name is missing or unknown.
    """
    rows = unknown_rows(arrays["time_s"].size)
    for name in (*NEEDED, *(arrays.keys() - NEEDED)):
        part = rows[:, ARRAYS[name]]
        if arrays[name].dtype.kind not in "biuf":
            raise OutputError(f"{name} holds {arrays[name].dtype.name}, not numbers")
        if arrays[name].shape != part.shape:
            raise OutputError(f"{name} has shape {arrays[name].shape}; with these times it must be {part.shape}")
        part[:] = arrays[name]
    return rows
