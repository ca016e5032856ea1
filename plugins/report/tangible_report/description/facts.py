"""Facts about the parts of a surface, independent of any language."""

import math
from typing import NamedTuple

import numpy as np
from jaxtyping import Float32, Float64, Int32, Int64

from tangible_core.data import HapticSurface, MaterialMap, PartMap
from tangible_core.parts.neighbours import neighbours
from tangible_legibility.cells import resampled
from tangible_legibility.words.places import place_of_counts

MOST_CELLS = 512
"""The most cells along a side: surfaces are described on a grid of at most this size."""


class PartFacts(NamedTuple):
    """Facts about one part."""

    number: int
    name: str
    """The name; empty if the part has none."""
    place: str
    """The place of most of the part, as a key of every language's words; `- -` for no side."""
    share: float
    """The part's share of the picture."""
    size_m: tuple[float, float]
    """The extent from left to right, and from far to near."""
    height_m: float
    """The median height above the base plane."""
    material: str
    """The material's name in the library; empty if none is known."""
    neighbours: tuple[int, ...]
    """The numbers of the parts that it borders on, the longest border first."""


def facts(
    surface: HapticSurface,
    materials: MaterialMap | None = None,
    parts: PartMap | None = None,
    names: tuple[str, ...] = (),
) -> tuple[PartFacts, ...]:
    """Return facts about the parts of a surface from near to far: the highest first.

    materials: those of the surface's labels, if the surface has none. parts, names: parts of any size, in place of the
    surface's own labels and names.

    >>> bar = HapticSurface.from_heights(np.eye(2), 0.08, np.eye(2, dtype=np.int32))
    >>> [(each.number, each.height_m, each.neighbours) for each in facts(bar)]
    [(1, 1.0, (0,)), (0, 0.0, (1,))]
    """
    if (whole := surface.labels if parts is None else parts.labels) is None:
        return ()
    named = (surface.names or ()) if parts is None else names
    step = step_of(whole)
    labels = whole[::step, ::step]
    unique, dense = np.unique(labels, return_inverse=True)
    numbers: list[int] = unique.tolist()
    count = len(numbers)
    dense = dense.reshape(labels.shape).astype(np.int32)
    height_m = median_heights_m(dense, resampled(surface.height_m, labels.shape), count)
    share = np.bincount(dense.ravel()) / dense.size
    down, across = _count_cells(dense, count, 0), _count_cells(dense, count, 1)
    material_of, neighbours_of = _materials(surface, materials, dense, count), _neighbours(dense, count)
    unsorted = [
        PartFacts(
            number,
            named[number].strip() if number < len(named) else "",
            place_of_counts(down[each], across[each]),
            float(share[each]),
            (surface.extent_m[0] * _span(across[each]), surface.extent_m[1] * _span(down[each])),
            float(height_m[each]),
            material_of[each],
            tuple(numbers[other] for other in neighbours_of[each]),
        )
        for each, number in enumerate(numbers)
    ]
    return tuple(sorted(unsorted, key=lambda part: (-part.height_m, part.number)))


def step_of(cells: np.ndarray) -> int:
    """Return the n such that every n-th row and column have at most MOST_CELLS cells a side."""
    return math.ceil(max(cells.shape) / MOST_CELLS)


def median_heights_m(
    labels: Int32[np.ndarray, "h w"], height_m: Float32[np.ndarray, "h w"], count: int
) -> Float64[np.ndarray, " n"]:
    """Return the median height of each of n parts; NaN for a part without cells."""
    order = np.argsort(labels, axis=None, kind="stable")
    ends = np.cumsum(np.bincount(labels.ravel(), minlength=count))
    parts = np.split(height_m.ravel()[order].astype(np.float64), ends[:-1])
    return np.array([np.median(part) if part.size else np.nan for part in parts])


def _count_cells(dense: Int32[np.ndarray, "h w"], count: int, axis: int) -> Int64[np.ndarray, "n k"]:
    """Return the number of cells that each part has in every row (axis 0) or column (axis 1)."""
    size = dense.shape[axis]
    cells = dense.astype(np.int64) * size + np.indices(dense.shape, sparse=True)[axis]
    return np.bincount(cells.ravel(), minlength=count * size).reshape(count, size)


def _span(counts: Int64[np.ndarray, " k"]) -> float:
    """Return the distance from the first row or column with a cell to the last, as a share of all."""
    used = np.flatnonzero(counts)
    return int(used[-1] - used[0] + 1) / counts.size


def _materials(
    surface: HapticSurface, materials: MaterialMap | None, dense: Int32[np.ndarray, "h w"], count: int
) -> list[str]:
    """Return the name of the material of most of each part; empty if none is known."""
    known = surface.materials or (materials.materials if materials else ())
    if surface.labels is None or int(surface.labels.max()) >= len(known):
        return [""] * count
    label = resampled(surface.labels, dense.shape)
    pairs, cells = np.unique(dense.astype(np.int64) * len(known) + label, return_counts=True)
    by_size = pairs[np.argsort(cells, kind="stable")].tolist()
    most: dict[int, int] = dict(divmod(pair, len(known)) for pair in by_size)  # the last pair stays: the largest
    return [known[most[each]].name for each in range(count)]


def _neighbours(dense: Int32[np.ndarray, "h w"], count: int) -> list[list[int]]:
    """Return the neighbours of each part, the longest border first."""
    borders = neighbours(PartMap(dense, tuple(range(count))))
    neighbours_of: list[list[int]] = [[] for _ in range(count)]
    for each in np.argsort(-borders.sides, kind="stable").tolist():
        low, high = int(borders.low[each]), int(borders.high[each])
        neighbours_of[low].append(high)
        neighbours_of[high].append(low)
    return neighbours_of
