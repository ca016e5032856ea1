"""What the bars of a chart stand for, by the numbers on its axis."""
# scipy has no types.
# pyright: reportMissingTypeStubs=false, reportUnknownVariableType=false, reportUnknownMemberType=false

import re
from collections.abc import Sequence
from itertools import combinations
from typing import Any, cast

import numpy as np
from jaxtyping import Int32

from ..data import PictureText

MINUS = "\N{MINUS SIGN}"
NUMBER = re.compile(rf"[-{MINUS}]?\d+(?:[.,]\d+)?")
MIN_NUMBERS = 3  # the least number of texts that are an axis
NEAR = 0.012  # how far edges that are on one line may lie from it, as a share of the picture's side
OFF = 0.02  # how far a number may lie from where the others want it, as a share of their range
FULL = 0.9  # the least share of its rectangle that a bar fills
FINE = 10  # the steps by which values are rounded, in one step of the axis


def bar_values(labels: Int32[np.ndarray, "h w"], texts: Sequence[PictureText]) -> dict[int, float]:
    """Return the value of each bar of a chart by the label of its part; {} for other pictures.

    Bars are parts that are rectangles and begin on one line, upright or level. An axis is at least three numbers on
    one line, evenly scaled; a number that was misread is left out.

    >>> labels = np.zeros((100, 100), np.int32)
    >>> labels[50:90, 40:50], labels[30:90, 60:70] = 1, 2
    >>> bar_values(labels, [PictureText(str(n), (0.1, 0.88 - n / 50, 0.2, 0.92 - n / 50)) for n in (0, 10, 20)])
    {1: 20.0, 2: 30.0}
    """
    for axis in (0, 1):
        if (scale := _scale(texts, axis)) and len(ends := _bar_ends(labels, axis)) > 1:
            at_0, slope, step = scale
            return {label: round((at_0 + slope * end) / step) * step for label, end in ends.items()}
    return {}


def _scale(texts: Sequence[PictureText], axis: int) -> tuple[float, float, float] | None:
    """Return the value at 0, the change of it from side to side, and the step of rounding; None without an axis."""
    # The median of all slopes holds if a number was misread (Sen, JASA 63, 1968).
    level = [text for text in texts if text.is_level and NUMBER.fullmatch(text.content)]
    values = np.array([float(text.content.replace(MINUS, "-").replace(",", ".")) for text in level])
    edges = np.array([text.box for text in level]).reshape(-1, 2, 2)[..., ::-1]  # row and column
    middles = edges.mean(axis=1)
    lines = middles[:, 1 - axis], *([edges[:, 1, 1]] if axis == 0 else [])  # the numbers of an upright axis end there
    on_line = max(
        (np.flatnonzero(np.abs(line - place) < NEAR) for line in lines for place in line), key=len, default=np.array([])
    )
    if len(on_line) < MIN_NUMBERS:
        return None
    values, places = values[on_line], middles[on_line, axis]
    pairs = [pair for pair in combinations(range(len(values)), 2) if abs(places[pair[0]] - places[pair[1]]) > NEAR]
    slope = float(np.median([(values[b] - values[a]) / (places[b] - places[a]) for a, b in pairs] or [0]))
    at_0 = float(np.median(values - slope * places))
    right = np.abs(values - at_0 - slope * places) <= OFF * np.ptp(places) * abs(slope)
    if not slope or right.sum() < max(MIN_NUMBERS, len(values) / 2):
        return None
    return at_0, slope, float(np.diff(np.unique(values[right])).min()) / FINE


def _bar_ends(labels: Int32[np.ndarray, "h w"], axis: int) -> dict[int, float]:
    """Return where the bars along an axis end, as shares of the picture's side, by the labels of their parts."""
    from scipy.ndimage import find_objects

    sides, sizes = labels.shape, np.bincount(labels.reshape(-1))
    begins, ends = dict[int, float](), dict[int, float]()
    places = cast("list[Any]", find_objects(labels + 1))
    for label, place in enumerate(places):
        spans: list[tuple[int, int]] = [(at.start, at.stop) for at in place or ()]
        is_whole = all(start > 0 and stop < side for (start, stop), side in zip(spans, sides, strict=False))
        if spans and is_whole and sizes[label] >= FULL * np.prod(np.diff(spans)):
            first, last = (edge / sides[axis] for edge in spans[axis])
            begins[label], ends[label] = (last, first) if axis == 0 else (first, last)
    lines = [[label for label in begins if abs(begins[label] - begin) < NEAR] for begin in begins.values()]
    return {label: ends[label] for label in (max(lines, key=len) if lines else ())}
