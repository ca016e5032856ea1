"""Ten pictures of parts, made of shapes and chance, as reliefs: what a hand explores and an ear is to understand."""

from typing import Any, NamedTuple

import numpy as np
from jaxtyping import Float32, Int32
from scipy import ndimage

from tangible_core.data import PartMap, SegmentMap
from tangible_core.parts import HeightChoice, find_parts
from tangible_core.parts.layering import Layering

ROWS, COLUMNS, WIDTH_M = 240, 320, 0.08
PITCH_M = WIDTH_M / COLUMNS
SMOOTH_M = 0.001  # standard deviation by which a pipeline file smooths the borders of parts
# Smallest part, cells, 10 square millimetres: smaller ones go to a neighbour.
MIN_CELLS = 160
MAX_HIGH_M = 0.0042
NAMES = (
    "wall", "table", "cup", "jug", "cloth", "apple", "window", "door", "roof", "tree", "hill", "road", "river", "boat",
    "bird", "head", "hat", "hand", "coat", "chair", "lamp", "book", "bowl", "spoon", "star",
)  # fmt: skip
MATERIALS = ("wood", "stone", "cloth", "glass", "sand", "metal")


class Picture(NamedTuple):
    """A relief of parts."""

    kind: str
    parts: PartMap
    height_m: Float32[np.ndarray, "r c"]
    names: tuple[str, ...] | None
    materials: tuple[str, ...]

    def as_data(self) -> dict[str, Any]:
        """Return it as plugins/web/test/speech/exploration.ts takes it."""
        return {
            "rows": ROWS,
            "columns": COLUMNS,
            "extent_m": [WIDTH_M, ROWS * PITCH_M],
            "heights_m": [round(each, 6) for each in self.height_m.ravel().tolist()],
            "labels": self.parts.labels.ravel().tolist(),
            "names": self.names,
            "materials": self.materials,
        }


def pictures() -> list[Picture]:
    """Return the ten pictures, always the same. Every second one has names for its parts."""
    made = [
        _picture(kind, labels(np.random.default_rng(seed)), np.random.default_rng(100 + seed), seed % 2 == 0)
        for seed, (kind, labels) in enumerate(KINDS.items())
    ]
    assert len(made) == 10
    return made


def _picture(kind: str, labels: np.ndarray, rng: np.random.Generator, named: bool) -> Picture:
    parts = find_parts(SegmentMap(_without_specks(labels.astype(np.int32))))
    grain = ndimage.gaussian_filter(rng.random((ROWS, COLUMNS)), 4)
    picture = (255 * (grain - grain.min()) / np.ptp(grain)).astype(np.uint8)
    heights_m = MAX_HIGH_M * rng.permutation(parts.count) / max(1, parts.count - 1)
    relief = Layering(parts, WIDTH_M, HeightChoice(by="given"), picture).relief(heights_m.tolist())
    height_m = ndimage.gaussian_filter(relief.height_m, SMOOTH_M / PITCH_M, mode="nearest").astype(np.float32)
    names = tuple(rng.permutation(NAMES)[: parts.count].tolist()) if named else None
    materials = tuple(MATERIALS[index] for index in rng.integers(0, len(MATERIALS), parts.count))
    return Picture(kind, parts, height_m, names, materials)


def _without_specks(labels: Int32[np.ndarray, "r c"]) -> Int32[np.ndarray, "r c"]:
    parts = find_parts(SegmentMap(labels)).labels
    small = (np.bincount(parts.ravel()) < MIN_CELLS)[parts]
    nearest: Any = ndimage.distance_transform_edt(small, return_distances=False, return_indices=True)
    return parts[nearest[0], nearest[1]]


def _grid() -> tuple[np.ndarray, np.ndarray]:
    y, x = np.mgrid[:ROWS, :COLUMNS]
    return 4 * (x + 0.5) / COLUMNS, 3 * (y + 0.5) / ROWS


def _rectangles(rng: np.random.Generator) -> np.ndarray:
    boxes = [(0, 0, ROWS, COLUMNS)]
    while len(boxes) < 10:
        top, left, rows, columns = boxes.pop(max(range(len(boxes)), key=lambda each: boxes[each][2] * boxes[each][3]))
        share = rng.uniform(0.35, 0.65)
        if rows > 0.75 * columns:
            cut = int(share * rows)
            boxes += [(top, left, cut, columns), (top + cut, left, rows - cut, columns)]
        else:
            cut = int(share * columns)
            boxes += [(top, left, rows, cut), (top, left + cut, rows, columns - cut)]
    labels = np.zeros((ROWS, COLUMNS), np.int32)
    for number, (top, left, rows, columns) in enumerate(boxes):
        labels[top : top + rows, left : left + columns] = number
    return labels


def _cells(rng: np.random.Generator) -> np.ndarray:
    x, y = _grid()
    seeds = rng.random((13, 2)) * (4, 3)
    return np.argmin([np.hypot(x - u, y - v) for u, v in seeds], axis=0)


def _rings(rng: np.random.Generator) -> np.ndarray:
    x, y = _grid()
    u, v = rng.uniform(1.7, 2.3), rng.uniform(1.3, 1.7)
    return np.digitize(np.hypot(x - u, 1.25 * (y - v)), [0.35, 0.7, 1.05, 1.4])


def _discs(rng: np.random.Generator) -> np.ndarray:
    x, y = _grid()
    labels = np.zeros((ROWS, COLUMNS), np.int32)
    for number in range(1, 9):
        u, v, radius = rng.uniform(0.4, 3.6), rng.uniform(0.4, 2.6), rng.uniform(0.3, 0.7)
        labels[np.hypot(x - u, y - v) < radius] = number
    return labels


def _waves(rng: np.random.Generator) -> np.ndarray:
    x, y = _grid()
    return np.floor(2.2 * (y + 0.25 * np.sin(2 * x + rng.uniform(0, 6)) + 0.1 * np.sin(5 * x))).astype(np.int32) + 3


def _bricks(rng: np.random.Generator) -> np.ndarray:
    x, y = _grid()
    row = np.floor(y / 0.75).astype(np.int32)
    return row * 8 + np.floor((x + 0.6 * (row % 2) + rng.uniform(0, 0.3)) / 1.2).astype(np.int32)


def _blobs(rng: np.random.Generator) -> np.ndarray:
    noise = ndimage.gaussian_filter(rng.random((ROWS, COLUMNS)), 24)
    return np.digitize(noise, np.quantile(noise, (0.3, 0.55, 0.8)))


def _head(rng: np.random.Generator) -> np.ndarray:
    x, y = _grid()
    labels = np.where(x < rng.uniform(1, 1.4), 0, 1)
    labels = np.where(y > 2.55, 2, labels)
    labels = np.where((np.hypot((x - 2) / 1.3, (y - 2.6) / 0.9) < 1) & (y < 2.75), 3, labels)
    labels = np.where(np.hypot((x - 2) / 0.55, (y - 1.3) / 0.7) < 1, 4, labels)
    labels = np.where((np.hypot((x - 2) / 0.75, (y - 0.75) / 0.55) < 1) & (y < 0.85), 5, labels)
    return np.where(np.hypot(x - 2.9, y - 2.2) < 0.35, 6, labels)


def _lines(rng: np.random.Generator) -> np.ndarray:
    x, y = _grid()
    labels = np.zeros((ROWS, COLUMNS), np.int32)
    for number in range(4):
        angle, off = rng.uniform(0, np.pi), rng.uniform(-0.5, 0.5)
        labels += (((x - 2) * np.cos(angle) + (y - 1.5) * np.sin(angle)) > off) * 2**number
    return labels


def _landscape(rng: np.random.Generator) -> np.ndarray:
    x, y = _grid()
    labels = np.where(y > 1.4 + 0.2 * np.sin(2 * x + rng.uniform(0, 6)), 1, 0)
    labels = np.where(y > 2.2 + 0.15 * np.sin(3 * x), 2, labels)
    labels = np.where((abs(x - 1.2) < 0.6) & (y > 1.1) & (y < 2.4), 3, labels)
    labels = np.where((y > 0.5) & (y < 1.1) & (abs(x - 1.2) < 1.2 * (y - 0.5) + 0.05), 4, labels)
    labels = np.where((abs(x - 1.2) < 0.17) & (y > 1.75) & (y < 2.4), 5, labels)
    labels = np.where((abs(x - 3) < 0.1) & (y > 1.3) & (y < 2.5), 6, labels)
    labels = np.where(np.hypot(x - 3, y - 1) < 0.5, 7, labels)
    return np.where(np.hypot(x - 3.5, y - 0.35) < 0.22, 8, labels)


KINDS = {
    "rectangles": _rectangles, "cells": _cells, "rings": _rings, "discs": _discs, "waves": _waves, "bricks": _bricks,
    "blobs": _blobs, "a head": _head, "lines": _lines, "a landscape": _landscape,
}  # fmt: skip
