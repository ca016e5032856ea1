"""What is known of the parts of a surface, apart from the words of any language."""

import math
from typing import NamedTuple

import numpy as np
from jaxtyping import Float32, Float64, Int32, Int64

from tangible_core.data import HapticSurface, MaterialMap, PartMap
from tangible_core.parts.neighbours import neighbours
from tangible_core.parts.words.places import place_of_counts

MOST_CELLS = 512
"""A side: what is said of a part shows on so many."""


class PartFacts(NamedTuple):
    """What is known of one part."""

    number: int
    name: str
    """Empty where nobody gave it one."""
    place: str
    """Key of the place where most of it lies, in every language's words; `- -` for no side."""
    share: float
    """Of the picture."""
    size_m: tuple[float, float]
    """From its left-most to its right-most place, and from its farthest to its nearest."""
    height_m: float
    """Of its middle: half of the part is higher. Above the base plane."""
    material: str
    """By its name in the library; empty where none is known."""
    neighbours: tuple[int, ...]
    """Numbers of the parts that it borders on, the longest border first."""


def facts(
    surface: HapticSurface,
    materials: MaterialMap | None = None,
    parts: PartMap | None = None,
    names: tuple[str, ...] = (),
) -> tuple[PartFacts, ...]:
    """The parts of a surface from near to far: the highest first.

    materials: of the surface's labels, where it brings none. parts, names: what it is divided into, in place of the
    surface's own labels and names; of any size.

    >>> bar = HapticSurface.from_heights(np.eye(2), 0.08, np.eye(2, dtype=np.int32))
    >>> [(each.number, each.height_m, each.neighbours) for each in facts(bar)]
    [(1, 1.0, (0,)), (0, 0.0, (1,))]
    """
    if (whole := surface.labels if parts is None else parts.labels) is None:
        return ()
    named = (surface.names or ()) if parts is None else names
    step = math.ceil(max(whole.shape) / MOST_CELLS)
    labels = whole[::step, ::step]
    found, dense = np.unique(labels, return_inverse=True)
    there: list[int] = found.tolist()
    dense = dense.reshape(labels.shape).astype(np.int32)
    height_m = middle_heights_m(dense, _under(surface.height_m, labels.shape), len(there))
    share = np.bincount(dense.ravel()) / dense.size
    down, across = _spread(dense, len(there), 0), _spread(dense, len(there), 1)
    felt, beside = _felt(surface, materials, dense, len(there)), _beside(dense, len(there))
    made = [
        PartFacts(
            number,
            named[number].strip() if number < len(named) else "",
            place_of_counts(down[each], across[each]),
            float(share[each]),
            (surface.extent_m[0] * _span(across[each]), surface.extent_m[1] * _span(down[each])),
            float(height_m[each]),
            felt[each],
            tuple(there[other] for other in beside[each]),
        )
        for each, number in enumerate(there)
    ]
    return tuple(sorted(made, key=lambda part: (-part.height_m, part.number)))


def middle_heights_m(
    labels: Int32[np.ndarray, "h w"], height_m: Float32[np.ndarray, "h w"], count: int
) -> Float64[np.ndarray, " n"]:
    """The middle height of each of so many parts; NaN for one that is nowhere."""
    order = np.argsort(labels, axis=None, kind="stable")
    ends = np.cumsum(np.bincount(labels.ravel(), minlength=count))
    parts = np.split(height_m.ravel()[order].astype(np.float64), ends[:-1])
    return np.array([np.median(part) if part.size else np.nan for part in parts])


def _under(values: np.ndarray, shape: tuple[int, ...]) -> np.ndarray:
    """The values that lie under the centres of cells of another size."""
    rows, columns = (
        ((np.arange(wanted) + 0.5) * had / wanted).astype(np.intp)
        for had, wanted in zip(values.shape, shape, strict=True)
    )
    return values[np.ix_(rows, columns)]


def _spread(dense: Int32[np.ndarray, "h w"], count: int, axis: int) -> Int64[np.ndarray, "n k"]:
    """How many cells each part has in every row, or in every column."""
    size = dense.shape[axis]
    cells = dense.astype(np.int64) * size + np.indices(dense.shape, sparse=True)[axis]
    return np.bincount(cells.ravel(), minlength=count * size).reshape(count, size)


def _span(counts: Int64[np.ndarray, " k"]) -> float:
    """From the first row or column that holds any to the last, as a share of all."""
    held = np.flatnonzero(counts)
    return int(held[-1] - held[0] + 1) / counts.size


def _felt(
    surface: HapticSurface, materials: MaterialMap | None, dense: Int32[np.ndarray, "h w"], count: int
) -> list[str]:
    """The name of the material that most of each part is of; empty where none is known."""
    felt = surface.materials or (materials.materials if materials else ())
    if surface.labels is None or int(surface.labels.max()) >= len(felt):
        return [""] * count
    label = _under(surface.labels, dense.shape)
    pairs, cells = np.unique(dense.astype(np.int64) * len(felt) + label, return_counts=True)
    by_size = pairs[np.argsort(cells, kind="stable")].tolist()
    most: dict[int, int] = dict(divmod(pair, len(felt)) for pair in by_size)  # the last one stays: the largest
    return [felt[most[each]].name for each in range(count)]


def _beside(dense: Int32[np.ndarray, "h w"], count: int) -> list[list[int]]:
    """Of each part, those that it borders on, the longest border first."""
    found = neighbours(PartMap(dense, tuple(range(count))))
    beside: list[list[int]] = [[] for _ in range(count)]
    for each in np.argsort(-found.sides, kind="stable").tolist():
        low, high = int(found.low[each]), int(found.high[each])
        beside[low].append(high)
        beside[high].append(low)
    return beside
