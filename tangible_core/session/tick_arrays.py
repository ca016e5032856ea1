"""The columns of ticks by what they are of: time, position, force."""

from collections.abc import Mapping

import numpy as np
from jaxtyping import Float64

from ..data import TICK_COLUMNS
from ..errors import OutputError

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
"""Where each property of a recording, and array of an .npz, stands in a row of `TICK_COLUMNS`."""
NEEDED = ("time_s", "position_m", "velocity_m_per_s", "force_n")
"""What each recording has; the rest may be unknown:"""
UNKNOWN = {
    "late_s": 0.0,
    "proxy_x_m": np.nan,
    "proxy_y_m": np.nan,
    "proxy_z_m": np.nan,
    "flags": 0.0,
    "buttons": 0.0,
    "frame": np.nan,
}


def unknown(count: int) -> Float64[np.ndarray, "n columns"]:
    """Ticks of which nothing is known."""
    return np.tile([UNKNOWN.get(name, 0.0) for name in TICK_COLUMNS], (count, 1))


def joined(arrays: Mapping[str, np.ndarray]) -> Float64[np.ndarray, "n columns"]:
    """Rows of `TICK_COLUMNS` from `ARRAYS` by name; those that are left out, but not `NEEDED`, were not known.

    Raises: OutputError if the arrays are not of one length, KeyError if a name is missing or unknown.
    """
    rows = unknown(arrays["time_s"].size)
    for name in (*NEEDED, *(arrays.keys() - NEEDED)):
        part = rows[:, ARRAYS[name]]
        if arrays[name].dtype.kind not in "biuf":
            raise OutputError(f"{name} holds {arrays[name].dtype.name} and no numbers")
        if arrays[name].shape != part.shape:
            raise OutputError(f"{name} is {arrays[name].shape}; with these times it is {part.shape}")
        part[:] = arrays[name]
    return rows
