"""Paths of a scripted hand: closed strokes at constant speed, and recordings read from a CSV file."""

import math
from bisect import bisect_right
from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import final

import numpy as np
from jaxtyping import Float64

from tangible_core.data import Vector
from tangible_core.errors import DeviceError, did_you_mean, quoted
from tangible_core.files import read_table

Points = Float64[np.ndarray, "n 3"]
COLUMNS = ("time_s", "x_m", "y_m", "z_m")  # columns that a CSV file must have; others are ignored


@final
@dataclass(frozen=True)
class Stroke:
    """Points and times from 0, joined by straight lines; a closed one repeats exactly, an open one stays at its end."""

    times_s: tuple[float, ...]
    points_m: tuple[Vector, ...]
    period_s: float
    lap_ticks: int | None  # ticks until a closed stroke repeats; None for an open one

    def at(self, tick: int) -> Vector:
        """Return the position at a tick; negative ticks are before the start."""
        if self.lap_ticks is None:
            time_s = min(max(tick, 0) * self.period_s, self.times_s[-1])
        else:
            time_s = tick % self.lap_ticks * self.period_s
        after = min(bisect_right(self.times_s, time_s), len(self.times_s) - 1)
        before = max(after - 1, 0)
        span = self.times_s[after] - self.times_s[before]
        share = (time_s - self.times_s[before]) / span if span else 0.0
        (ax, ay, az), (bx, by, bz) = self.points_m[before], self.points_m[after]
        return ax + share * (bx - ax), ay + share * (by - ay), az + share * (bz - az)


def walk(points_m: Points, speed_m_per_s: float, period_s: float) -> Stroke:
    """Return a closed stroke at constant speed, reduced so that a lap takes a whole number of periods."""
    ring = np.vstack([points_m, points_m[:1]])
    lengths = np.linalg.norm(np.diff(ring, axis=0), axis=1)
    way = np.concatenate([[0.0], np.cumsum(lengths)])
    ticks = max(1, math.ceil(float(way[-1]) / (speed_m_per_s * period_s) - 1e-9))
    times = way * (ticks * period_s / way[-1])
    return Stroke(tuple(times.tolist()), _vectors(ring), period_s, ticks)


def raster(size_m: tuple[float, float], lines: int, low_m: float, high_m: float) -> Points:
    """Return lines to the right and back to the left, from far to near."""
    y = np.repeat(np.linspace(size_m[1] / 2, -size_m[1] / 2, lines), 2)
    x = np.resize([-0.5, 0.5, 0.5, -0.5], 2 * lines) * size_m[0]
    return np.column_stack([x, y, np.full(2 * lines, low_m)])


def circle(size_m: tuple[float, float], lines: int, low_m: float, high_m: float) -> Points:
    """Return an ellipse of this size, counter-clockwise from the right; its error is below 2e-6 of its size."""
    turn = np.linspace(0, 2 * np.pi, 1000, endpoint=False)
    return _around(size_m, turn, np.ones(1000), low_m)


def spiral(size_m: tuple[float, float], lines: int, low_m: float, high_m: float) -> Points:
    """Return a spiral from the centre outwards in evenly spaced turns, and back the same way."""
    turn = np.linspace(0, 2 * np.pi * lines, 250 * lines)
    out = _around(size_m, turn, np.linspace(0, 1, 250 * lines), low_m)
    return np.vstack([out, out[-2:0:-1]])


def press(size_m: tuple[float, float], lines: int, low_m: float, high_m: float) -> Points:
    """Return a line straight down at the centre, and up again."""
    return np.array([[0.0, 0.0, high_m], [0.0, 0.0, low_m]])


# Paths by name; each takes size_m, lines, low_m and high_m.
DRAWN: dict[str, Callable[[tuple[float, float], int, float, float], Points]] = {
    "raster": raster,
    "circle": circle,
    "spiral": spiral,
    "press": press,
}


# Largest share of a surface's width and length that a path takes, as hands overshoot.
LARGEST_SHARE = 0.75


def path_size(extent_m: tuple[float, float], most_m: tuple[float, float]) -> tuple[float, float]:
    """Return width and length of a path over a surface of this size: the greatest, or less if the surface is small."""
    return min(LARGEST_SHARE * extent_m[0], most_m[0]), min(LARGEST_SHARE * extent_m[1], most_m[1])


def read_csv(path: Path, period_s: float) -> Stroke:
    """Read a recorded stroke, played once: columns time_s, x_m, y_m, z_m, times rising. Raises: DeviceError."""
    try:
        columns, lines = read_table(path)
        _check_columns(path, columns)
        rows = [(number, _numbers(path, number, row)) for number, row in lines]
    except OSError as error:
        raise DeviceError(f"{path}: cannot be read: {error.strerror}; check csv_file") from error
    except ValueError as error:
        raise DeviceError(f"{path}: is not a CSV text file ({error}); save it as CSV in UTF-8") from error
    if not rows:
        raise DeviceError(f"{path}: has no rows; write one row per moment: {','.join(COLUMNS)}")
    for (_, before), (line, after) in pairwise(rows):
        if not after[0] > before[0]:
            raise DeviceError(f"{path}:{line}: time_s {after[0]:g} does not come after {before[0]:g}; sort the rows")
    table = np.array([numbers for _, numbers in rows])
    return Stroke(tuple((table[:, 0] - table[0, 0]).tolist()), _vectors(table[:, 1:]), period_s, None)


def _around(size_m: tuple[float, float], turn: np.ndarray, radius: np.ndarray, height_m: float) -> Points:
    x, y = size_m[0] / 2 * radius * np.cos(turn), size_m[1] / 2 * radius * np.sin(turn)
    return np.column_stack([x, y, np.full(turn.size, height_m)])


def _vectors(points_m: np.ndarray) -> tuple[Vector, ...]:
    return tuple((x, y, z) for x, y, z in points_m.tolist())


def _check_columns(path: Path, names: list[str]) -> None:
    for column in COLUMNS:
        if column not in names:
            hint = did_you_mean(column, names) or f"; there are {', '.join(names) or 'none'}"
            raise DeviceError(f"{path}:1: there is no column {column}{hint}; the first line names {','.join(COLUMNS)}")


def _numbers(path: Path, line: int, row: dict[str, str]) -> list[float]:
    values: list[float] = []
    for column in COLUMNS:
        text = row.get(column)
        try:
            value = float(text or "")
        except ValueError:
            value = math.nan
        if not math.isfinite(value):
            raise DeviceError(f"{path}:{line}: {column} is {quoted(text)}; write a finite number")
        values.append(value)
    return values
