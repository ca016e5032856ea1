"""The connected parts of a picture's segments, and where they are."""
# scikit-image has no types.
# pyright: reportMissingTypeStubs=false, reportUnknownVariableType=false

import numpy as np
from jaxtyping import Int

from ..data import SegmentMap
from ..data.views import PartMap


def find_parts(segments: SegmentMap) -> PartMap:
    """The connected pieces of the segments: pixels of one segment that share a side are of one part.

    Parts are numbered by their first pixels, row by row. So the parts and their numbers are the same in a picture that
    is enlarged by whole pixels, and whatever the segments are numbered; the last of them do not move if a new part
    comes after them.
    """
    from skimage.measure import label

    none = int(segments.labels.min()) - 1
    found = np.asarray(label(segments.labels, connectivity=1, background=none))
    parts = found.astype(np.int32)
    parts -= 1
    flat = parts.reshape(-1)
    known = np.maximum.accumulate(flat)  # numbers come in the order of first pixels, so a first pixel is a new maximum
    first = np.flatnonzero(np.diff(known, prepend=np.int32(-1)))
    return PartMap(parts, tuple(segments.labels.reshape(-1)[first].tolist()))


def reduced_parts(parts: PartMap, shape: tuple[int, int]) -> PartMap:
    """The parts of a picture on a coarser grid of (r, c), with the same numbers: those of the middle pixels.

    A part that would be lost, as it lies between these, keeps one cell; one that has no pixel has none here.
    """
    whole = parts.labels
    if whole.shape == shape:
        return parts
    rows, columns = (np.arange(new) * old // new + old // new // 2 for new, old in zip(shape, whole.shape, strict=True))
    labels = whole[np.ix_(rows, columns)]
    lost = np.flatnonzero(np.bincount(labels.reshape(-1), minlength=parts.count) == 0)
    lost = lost[part_sizes(parts)[lost] > 0] if lost.size else lost
    row, column = np.divmod(_first_pixels(parts)[lost], whole.shape[1])
    labels[row * shape[0] // whole.shape[0], column * shape[1] // whole.shape[1]] = lost
    return PartMap(labels, parts.segments)


def part_sizes(parts: PartMap) -> Int[np.ndarray, "n"]:
    """Pixels of each part."""
    return np.bincount(parts.labels.reshape(-1), minlength=parts.count)


def _first_pixels(parts: PartMap) -> Int[np.ndarray, "n"]:
    """Index of each part's first pixel, row by row; that of the last pixel for a part without any."""
    flat = parts.labels.reshape(-1)
    first = np.full(parts.count, flat.size - 1, np.int64)
    first[flat[::-1]] = np.arange(flat.size - 1, -1, -1)
    return first
