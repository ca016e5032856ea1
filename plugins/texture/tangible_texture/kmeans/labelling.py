"""A label map from features, by k-means."""

import logging
from typing import Literal

import numpy as np
from jaxtyping import Float32, Int32

from tangible_core.data import SegmentMap
from tangible_core.plugins.notes import note

from .count import choose_count
from .lloyd import kmeans

log: logging.Logger = logging.getLogger(__name__)
MOST_SEGMENTS = 8
"""The largest number of segments under `auto`."""


def choose_segments(rows: Float32[np.ndarray, "n d"], segments: int | Literal["auto"], seed: int) -> int:
    """Return the requested number, or for `auto` an estimate, reported with its confidence."""
    if segments != "auto":
        return segments
    estimate = choose_count(rows, MOST_SEGMENTS, seed)
    note(log, f"segments: {estimate.segments}, estimated with confidence {estimate.confidence:.2f}: {estimate.reason}")
    return estimate.segments


def segment_by_kmeans(
    features: Float32[np.ndarray, "rows columns d"],
    step_px: int,
    shape: tuple[int, int],
    segments: int | Literal["auto"],
    seed: int,
    start: Literal["plus-plus", "random"] = "plus-plus",
    restarts: int = 1,
) -> SegmentMap:
    """Cluster features sampled every step_px pixels, and give every pixel of (h, w) the label of its cell."""
    rows = features.reshape(-1, features.shape[2])
    clustering = kmeans(rows, choose_segments(rows, segments, seed), restarts, seed, start)
    return label_map_of_cells(
        clustering.labels.reshape(features.shape[:2]), margins(rows, clustering.centres), step_px, shape
    )


def label_map_of_cells(
    labels: Int32[np.ndarray, "rows columns"], trust: Float32[np.ndarray, "n"], step_px: int, shape: tuple[int, int]
) -> SegmentMap:
    """Repeat labels and confidence of cells for (h, w) pixels; labels are in the order of their first pixels."""
    from ..regions.merging import number_in_reading_order

    cells = np.ix_(*(np.arange(side) // step_px for side in shape))
    return SegmentMap(number_in_reading_order(labels.astype(np.int32))[cells], trust.reshape(labels.shape)[cells])


def margins(rows: Float32[np.ndarray, "n d"], centres: Float32[np.ndarray, "k d"]) -> Float32[np.ndarray, "n"]:
    """Return 1 - a / b of each row, a and b being its distances from the two nearest centres; 1 for one centre."""
    if len(centres) == 1:
        return np.ones(len(rows), np.float32)
    away = np.stack([np.sqrt(np.square(rows - centre).sum(axis=1)) for centre in centres], axis=1)
    near, next_near = np.partition(away, 1, axis=1)[:, :2].T
    return 1 - near / np.maximum(next_near, np.finfo(np.float32).tiny)
