"""Borders of parts: steps of height that can be felt, materials of neighbours, and what is left on pins."""

from math import log, nan
from typing import Any, NamedTuple

import numpy as np
from jaxtyping import Bool, Float64, Int64, Integer

from tangible_core.data import Material, PartMap, Relief, border_pixels
from tangible_core.errors import PictureError
from tangible_core.runtime import cv2, plain_opencv

from .cells import resampled

SKIN_M = 0.0005  # standard deviation of the Gaussian by which a fingertip blurs a relief
STEP_M, WITHIN_M = 0.0005, 0.002  # the least step that can be felt, and the distance within which it rises


def border_steps(relief: Relief, labels: Integer[np.ndarray, "h w"]) -> dict[str, float]:
    """Measure how well steps that can be felt and borders of parts agree: shares 0..1, NaN for a share of nothing."""
    if labels.shape != relief.height_m.shape:
        raise PictureError(f"the labels are {labels.shape} and the heights {relief.height_m.shape}; scale one of them")
    steps = felt_steps(relief)  # the measures compare reliefs; they were not validated with readers
    across, along = labels[:, 1:] != labels[:, :-1], labels[1:] != labels[:-1]
    pitch_x, pitch_y = relief.pitch_m
    sides = ((steps[:, 1:] | steps[:, :-1])[across], pitch_y), ((steps[1:] | steps[:-1])[along], pitch_x)
    length, felt_length = (sum(count(cells) * side for cells, side in sides) for count in (np.size, np.count_nonzero))
    at_borders = steps & _near(labels, relief.pitch_m)
    return {
        "borders_found": _share(felt_length, length),
        "steps_at_borders": _share(np.count_nonzero(at_borders), np.count_nonzero(steps)),
        "area_stepped": _share(np.count_nonzero(steps), steps.size),
    }


def felt_steps(relief: Relief) -> Bool[np.ndarray, "h w"]:
    """Find the cells at which a step can be felt, as in `border_steps`; the rim continues at its height."""
    width, length = (2 * max(1, int(WITHIN_M / 2 / pitch + 1e-6)) + 1 for pitch in relief.pitch_m)
    across, along = (SKIN_M / pitch for pitch in relief.pitch_m)
    window = np.ones((length, width), np.uint8)
    with plain_opencv():
        skin = np.asarray(
            cv2.GaussianBlur(relief.height_m, (0, 0), across, sigmaY=along, borderType=cv2.BORDER_REPLICATE)
        )
        return np.asarray(cv2.dilate(skin, window)) - np.asarray(cv2.erode(skin, window)) >= np.float32(STEP_M)


def _near(labels: Integer[np.ndarray, "h w"], pitch_m: tuple[float, float]) -> Bool[np.ndarray, "h w"]:
    from scipy.ndimage import distance_transform_edt

    at_border = border_pixels(labels)
    if not at_border.any():
        return at_border
    return np.asarray(distance_transform_edt(~at_border, sampling=pitch_m[::-1])) <= WITHIN_M * (1 + 1e-6)


def _share(part: float | np.integer[Any], whole: float | np.integer[Any]) -> float:
    return float(part / whole) if whole else nan


PIN_PITCH_M = 0.0025  # from pin to pin, of all braille displays


class PinDisplay(NamedTuple):
    """Parts as pins show them."""

    parts: tuple[tuple[int, int, tuple[int, int]], ...]  # number, pins, a cell on the grid of the parts
    # Share of the length of all borders that lies within a pin of a border that is shown; 1 without a border.
    kept: float


def show_on_pins(parts: PartMap, pitch_m: float) -> PinDisplay:
    """Return the pins of parts whose cells are pitch_m wide."""
    labels = parts.labels
    cell = max(1.0, PIN_PITCH_M / pitch_m)
    rows, columns = (max(1, round(size / cell)) for size in labels.shape)
    down = np.arange(labels.shape[0], dtype=np.int64) * rows // labels.shape[0]
    right = np.arange(labels.shape[1], dtype=np.int64) * columns // labels.shape[1]
    pin = np.add.outer(down * columns, right)
    pairs, votes = np.unique(pin * parts.count + labels, return_counts=True)
    order = np.argsort(votes, kind="stable")
    at, part = np.divmod(pairs[order], parts.count)
    pin_parts = np.zeros(rows * columns, np.int32)
    pin_parts[at] = part
    count = np.bincount(pin_parts, minlength=parts.count)
    first = np.unique(labels.reshape(-1), return_index=True)
    places = tuple(
        (int(number), int(count[number]), divmod(int(index), labels.shape[1]))
        for number, index in zip(*first, strict=True)
    )
    return PinDisplay(places, _share_of_borders(labels, pin_parts.reshape(rows, columns)[np.ix_(down, right)], cell))


def _share_of_borders(labels: np.ndarray, shown: np.ndarray, cell: float) -> float:
    borders, pin_borders = _borders(labels), _borders(shown)
    if not borders.any():
        return 1.0
    if not pin_borders.any():
        return 0.0
    with plain_opencv():
        far = np.asarray(cv2.distanceTransform((~pin_borders).view(np.uint8), cv2.DIST_L2, cv2.DIST_MASK_5))
    return float((far[borders] <= cell + 1).mean())


def _borders(labels: np.ndarray) -> np.ndarray:
    borders = np.zeros(labels.shape, np.bool_)
    borders[:, 1:] |= labels[:, 1:] != labels[:, :-1]
    borders[1:] |= labels[1:] != labels[:-1]
    return borders


BESIDE_M = 0.001  # from a border, on either side, to where the heights of a step are taken
# Relative difference of a property that a hand just notices. Sources: see docs/how-to/legibility.md.
NOTICEABLE = {"stiffness_n_per_m": 0.45, "dynamic_friction": 0.2, "roughness_m": 0.1, "grain_m": 0.1}
# Value of a property below which all values feel the same.
LEAST = {"stiffness_n_per_m": 50.0, "dynamic_friction": 0.03, "roughness_m": 5e-6, "grain_m": 1e-4}


class Steps(NamedTuple):
    """Pairs of neighbours, and the step of heights along their border."""

    low: Int64[np.ndarray, "m"]
    high: Int64[np.ndarray, "m"]  # parts' numbers, of which `low` is the smaller one
    step_m: Float64[np.ndarray, "m"]  # median along the border, without its sign
    length_m: Float64[np.ndarray, "m"]
    at: Int64[np.ndarray, "m 2"]  # row and column of a cell next to the border


def sample_relief(relief: Relief, shape: tuple[int, int]) -> Relief:
    """Sample a relief on a grid of another size: the heights nearest to its cells."""
    if relief.height_m.shape == shape:
        return relief
    return Relief(np.ascontiguousarray(resampled(relief.height_m, shape)), relief.extent_m)


def steps_between(parts: PartMap, pitch_m: float, relief: Relief | None) -> Steps:
    """Return the steps between all neighbours; NaN without a relief. relief: on the grid of the parts."""
    both = [_across(parts, pitch_m, relief, axis) for axis in (0, 1)]
    pair, step, row, column = (np.concatenate(columns) for columns in zip(*both, strict=True))
    order = np.lexsort((step, pair))
    pair, step, row, column = pair[order], step[order], row[order], column[order]
    starts = np.flatnonzero(np.diff(pair, prepend=-1))
    counts = np.diff(np.append(starts, pair.size))
    low, high = np.divmod(pair[starts], parts.count)
    counts_known = np.add.reduceat(np.isfinite(step), starts) if starts.size else np.zeros(0, np.int64)
    middle = starts + np.maximum(counts_known - 1, 0) // 2  # NaN is sorted last
    at = np.stack([row[starts + counts // 2], column[starts + counts // 2]], axis=1).astype(np.int64)
    return Steps(low, high, np.abs(step[middle]), counts * pitch_m, at)


def _across(
    parts: PartMap, pitch_m: float, relief: Relief | None, axis: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
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
    """Return the just noticeable differences of two materials in the property that differs most (Weber's law)."""
    smooth = "smooth" in (one.texture, other.texture)
    steps = [0.0 if one.texture == other.texture else 1.0]
    for name, share in NOTICEABLE.items():
        if name != "grain_m" or not smooth:
            values = (max(LEAST[name], float(getattr(material, name))) for material in (one, other))
            steps.append(abs(log(next(values) / next(values))) / log(1 + share))
    return max(steps)
