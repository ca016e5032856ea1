"""Connected parts of a picture's segments."""
# scikit-image has no types.
# pyright: reportMissingTypeStubs=false, reportUnknownVariableType=false

import numpy as np
from jaxtyping import Int

from ..data import SegmentMap
from ..data.views import PartMap
from ..scene.scaling import middle_pixels


def find_parts(segments: SegmentMap) -> PartMap:
    """Find the connected regions of the segments: pixels of one segment that share a side belong to one part."""
    from skimage.measure import label

    none = int(segments.labels.min()) - 1
    parts = np.asarray(label(segments.labels, connectivity=1, background=none)).astype(np.int32)
    parts -= 1
    flat = parts.reshape(-1)
    # So numbers do not depend on the segments' labels or on enlargement by whole pixels, and a new last part changes
    # none.
    largest = np.maximum.accumulate(flat)  # numbers are in the order of first pixels: each new maximum is a first pixel
    first = np.flatnonzero(np.diff(largest, prepend=np.int32(-1)))
    return PartMap(parts, tuple(segments.labels.reshape(-1)[first].tolist()))


def reduced_parts(parts: PartMap, shape: tuple[int, int]) -> PartMap:
    """Reduce parts to a coarser grid of (r, c), by the middle pixel of each cell, with the same numbers."""
    whole = parts.labels
    if whole.shape == shape:
        return parts
    labels = middle_pixels(whole, shape)
    missing = np.flatnonzero(np.bincount(labels.reshape(-1), minlength=parts.count) == 0)
    missing = missing[part_sizes(parts)[missing] > 0] if missing.size else missing
    # A part that has no middle pixel takes the cell of its first pixel, of several the last one.
    row, column = np.divmod(_first_pixels(parts)[missing], whole.shape[1])
    labels[row * shape[0] // whole.shape[0], column * shape[1] // whole.shape[1]] = missing
    return PartMap(labels, parts.segments)


def part_sizes(parts: PartMap) -> Int[np.ndarray, "n"]:
    """Count the pixels of each part."""
    return np.bincount(parts.labels.reshape(-1), minlength=parts.count)


def _first_pixels(parts: PartMap) -> Int[np.ndarray, "n"]:
    """Return the index of each part's first pixel, row by row; of the last pixel for a part without pixels."""
    flat = parts.labels.reshape(-1)
    first = np.full(parts.count, flat.size - 1, np.int64)
    first[flat[::-1]] = np.arange(flat.size - 1, -1, -1)
    return first
