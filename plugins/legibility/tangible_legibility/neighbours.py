"""Differences between neighbouring parts: the step of heights at their border, and their materials."""

from math import log
from typing import NamedTuple

import numpy as np
from jaxtyping import Float64, Int64

from tangible_core.data import Material, PartMap, Relief

from .cells import resampled

BESIDE_M = 0.001
"""Distance from a border, on either side, at which the heights of a step are taken."""
NOTICEABLE = {"stiffness_n_per_m": 0.45, "dynamic_friction": 0.2, "roughness_m": 0.1, "grain_m": 0.1}
"""Relative difference of a property that a hand just notices. Sources: see docs/legibility.md."""
LEAST = {"stiffness_n_per_m": 50.0, "dynamic_friction": 0.03, "roughness_m": 5e-6, "grain_m": 1e-4}
"""Value of a property below which all values feel the same."""


class Steps(NamedTuple):
    """Pairs of neighbours, and the step of heights along their border."""

    low: Int64[np.ndarray, "m"]
    high: Int64[np.ndarray, "m"]
    """Numbers of the parts, of which `low` is the smaller one."""
    step_m: Float64[np.ndarray, "m"]
    """Median along the border, without its sign."""
    length_m: Float64[np.ndarray, "m"]
    """Length of the border."""
    at: Int64[np.ndarray, "m 2"]
    """Row and column of a cell next to the border."""


def sample_relief(relief: Relief, shape: tuple[int, int]) -> Relief:
    """Sample a relief on a grid of another size: the heights nearest to its cells."""
    if relief.height_m.shape == shape:
        return relief
    return Relief(np.ascontiguousarray(resampled(relief.height_m, shape)), relief.extent_m)


def steps_between(parts: PartMap, pitch_m: float, relief: Relief | None) -> Steps:
    """Return the steps between all neighbours; NaN without a relief. relief: on the grid of the parts."""
    both = [_across(parts, pitch_m, relief, axis) for axis in (0, 1)]
    pair, step, row, column = (np.concatenate(each) for each in zip(*both, strict=True))
    order = np.lexsort((step, pair))
    pair, step, row, column = pair[order], step[order], row[order], column[order]
    starts = np.flatnonzero(np.diff(pair, prepend=-1))
    counts = np.diff(np.append(starts, pair.size))
    low, high = np.divmod(pair[starts], parts.count)
    known = np.add.reduceat(np.isfinite(step), starts) if starts.size else np.zeros(0, np.int64)
    middle = starts + np.maximum(known - 1, 0) // 2  # NaN is sorted last
    at = np.stack([row[starts + counts // 2], column[starts + counts // 2]], axis=1).astype(np.int64)
    return Steps(low, high, np.abs(step[middle]), counts * pitch_m, at)


def _across(
    parts: PartMap, pitch_m: float, relief: Relief | None, axis: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Return the pair, the step and the cell of each side of a cell that lies between two parts."""
    labels = parts.labels if axis == 0 else parts.labels.T
    row, column = np.nonzero(labels[1:] != labels[:-1])
    one, other = labels[row, column].astype(np.int64), labels[row + 1, column].astype(np.int64)
    step = np.full(row.size, np.nan)
    if relief is not None:
        heights = relief.height_m if axis == 0 else relief.height_m.T
        reach = max(1, round(BESIDE_M / pitch_m))
        before, after = np.maximum(row + 1 - reach, 0), np.minimum(row + reach, len(labels) - 1)
        step = (heights[after, column] - heights[before, column]).astype(np.float64)
        step = np.where(one < other, step, -step)
    cell = (row, column) if axis == 0 else (column, row)
    return np.minimum(one, other) * parts.count + np.maximum(one, other), step, *cell


def apart(one: Material, other: Material) -> float:
    """Return the just noticeable differences between two materials, in the property that differs most.

    Differences are those of logarithms (Weber's law); two textures differ by at least 1. The grain counts if both
    materials have one.
    """
    smooth = "smooth" in (one.texture, other.texture)
    steps = [0.0 if one.texture == other.texture else 1.0]
    for name, share in NOTICEABLE.items():
        if name != "grain_m" or not smooth:
            values = (max(LEAST[name], float(getattr(each, name))) for each in (one, other))
            steps.append(abs(log(next(values) / next(values))) / log(1 + share))
    return max(steps)
