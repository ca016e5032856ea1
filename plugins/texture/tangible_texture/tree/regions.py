"""The smallest regions of a picture, their borders, and sums over both. Compiled by numba."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float32, Float64, Int32, Int64

from tangible_core.compiled import KERNEL, inner, njit

from ..regions.borders import ACROSS, DOWN
from ..regions.refining import inner_cells
from ..regions.watershed import UNSEEN, watershed
from ..signal.smoothing import gaussian

# The standard deviation of the window in which strengths are smoothed before their minima are found, in cells.
CALM_CELLS = 0.7
REACH_CELLS = 3  # how far a border's direction is looked for to either side of a pair of cells


class Regions(NamedTuple):
    """Small regions and their borders; a pair is two cells that share a side, one in each of two regions."""

    labels: Int32[np.ndarray, "h w"]
    areas: Float64[np.ndarray, "n"]
    colours: Float64[np.ndarray, "n 3"]
    roughness: Float64[np.ndarray, "n bins"]
    borders: Int64[np.ndarray, "m 2"]
    pairs: Float64[np.ndarray, "m"]
    strengths: Float64[np.ndarray, "m"]


def small_regions(strength: Float32[np.ndarray, "h w"]) -> Int32[np.ndarray, "h w"]:
    """Flood a map of strengths from all its minima: regions that no change runs through."""
    from skimage.measure import label
    from skimage.morphology import local_minima

    calm = gaussian(strength, CALM_CELLS)
    calm -= calm.min()
    minima = np.asarray(local_minima(calm))
    markers = np.asarray(label(minima if minima.any() else calm == 0, connectivity=2)).astype(np.int32) - 1
    labels = watershed(calm, markers)
    # A region nowhere three cells wide, such as the blurred border between two things, goes to its neighbours.
    wide = np.unique(labels[inner_cells(labels)])
    if not 0 < wide.size <= labels.max():
        return labels
    names = np.full(int(labels.max()) + 1, UNSEEN, np.int32)
    names[wide] = np.arange(wide.size)
    return watershed(calm, np.where(markers == UNSEEN, UNSEEN, names[markers]))


def measure_regions(
    labels: Int32[np.ndarray, "h w"],
    colours: Float32[np.ndarray, "3 h w"],
    roughness: Float32[np.ndarray, "bins h w"],
    tensors: Float32[np.ndarray, "cues 3 h w"],
    weights: Float32[np.ndarray, "cues"],
) -> Regions:
    """Sum over cells and pairs. A pair's strength is that of the change across the border, weighted over the cues."""
    count = int(labels.max()) + 1
    flat = labels.reshape(-1)
    first, second = (np.concatenate(parts) for parts in zip(*_pairs(labels), strict=True))
    strengths = np.empty(first.size, np.float32)
    _measure_pairs(labels, first, second, tensors.reshape(*tensors.shape[:2], -1), weights, strengths)
    one, other = flat[first].astype(np.int64), flat[second].astype(np.int64)
    keys, which, pairs = np.unique(
        np.minimum(one, other) * count + np.maximum(one, other), return_inverse=True, return_counts=True
    )
    return Regions(
        labels,
        np.bincount(flat, minlength=count).astype(np.float64),
        _sums(flat, colours, count),
        _sums(flat, roughness, count),
        np.stack(np.divmod(keys, count), axis=1),
        pairs.astype(np.float64),
        np.bincount(which, strengths, keys.size),
    )


def _pairs(labels: Int32[np.ndarray, "h w"]) -> list[tuple[np.ndarray, np.ndarray]]:
    at = np.arange(labels.size).reshape(labels.shape)
    return [
        (at[one][differ], at[other][differ])
        for one, other in (DOWN, ACROSS)
        for differ in [labels[one] != labels[other]]
    ]


def _sums(flat: Int32[np.ndarray, "cells"], planes: Float32[np.ndarray, "d h w"], count: int) -> np.ndarray:
    return np.stack([np.bincount(flat, plane.reshape(-1), count) for plane in planes], axis=1)


@njit(**KERNEL)
def _measure_pairs(labels, first, second, tensors, weights, strengths):
    for pair in range(first.size):
        one, other = first[pair], second[pair]
        across, down = _normal(labels, one, other)
        half, total = np.float32(0.5), np.float32(0)
        xx, xy, yy = half * across * across, half * across * down, half * down * down
        for cue in range(len(tensors)):
            tensor = tensors[cue]
            square = (
                xx * (tensor[0, one] + tensor[0, other])
                + 2 * xy * (tensor[1, one] + tensor[1, other])
                + yy * (tensor[2, one] + tensor[2, other])
            )
            total += weights[cue] * np.sqrt(np.sqrt(max(square, np.float32(0))))
        strengths[pair] = total


@inner()
def _normal(labels, one, other):
    """Return the unit vector from the middle of one region to that of the other, within REACH_CELLS of a pair."""
    rows, columns = labels.shape
    row, column = one // columns, one % columns
    here, there = labels[row, column], labels[other // columns, other % columns]
    left, right, top, bottom, near, far = 0, 0, 0, 0, 0, 0
    for y in range(max(0, row - REACH_CELLS), min(rows, row + REACH_CELLS + 1)):
        for x in range(max(0, column - REACH_CELLS), min(columns, column + REACH_CELLS + 1)):
            if labels[y, x] == here:
                left, top, near = left + x, top + y, near + 1
            elif labels[y, x] == there:
                right, bottom, far = right + x, bottom + y, far + 1
    across, down = right * near - left * far, bottom * near - top * far
    if across == 0 and down == 0:
        across, down = other % columns - column, other // columns - row
    size = np.sqrt(np.float32(across * across + down * down))
    return np.float32(across) / size, np.float32(down) / size
