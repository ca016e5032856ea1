"""Merging of similar textures, until a finger can tell the remaining ones apart."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float64, Int32, Int64

from tangible_core.data import PartMap, to_rgb8
from tangible_core.runtime import plain_opencv

MOST_COMPARED = 256
"""Textures that are compared pairwise; the smallest of more go to the most similar of these."""

FAR = 1000.0
"""Difference in colour that is added between the figure and the ground: more than any two colours have."""


def count_textures(parts: PartMap, names: Sequence[str] = ()) -> int:
    """Count the textures of the parts that have a pixel: one a segment, without parts that a name distinguishes."""
    present = np.flatnonzero(np.bincount(parts.labels.reshape(-1), minlength=parts.count))
    return len({parts.segments[n] for n in present.tolist() if n >= len(names) or not names[n]})


def texture_kinds(
    parts: PartMap, names: Sequence[str], textures: int, picture: np.ndarray | None, front: Sequence[int] = ()
) -> Int32[np.ndarray, "n"]:
    """Return the kind of each part, from 0 on: a separate one for each named part, at most `textures` for the others.

    Kinds of unnamed parts are their segments. While there are too many, the two kinds are merged that add least to the
    spread of colours within textures (Ward 1963), in CIELAB; without a picture, the smallest kinds.
    front: numbers of the parts of the figure, which merge with each other rather than with the ground.
    """
    most, figure = max(parts.segments, default=0) + 1, set(front)
    keys = [
        -1 - n if n < len(names) and names[n] else segment + most * (n in figure)
        for n, segment in enumerate(parts.segments)
    ]
    order = {each: at for at, each in enumerate(dict.fromkeys(keys))}
    kinds = np.array([order[each] for each in keys], np.int32)
    size = np.bincount(kinds[parts.labels].reshape(-1), minlength=len(order))
    free = np.array([at for each, at in order.items() if each >= 0 and size[at]], np.int64)
    if free.size > textures:
        colour = np.zeros((len(order), 3)) if picture is None else _colours(picture, kinds[parts.labels], size)
        colour[:, 0] += FAR * np.array([each >= most for each in order])
        into = np.arange(len(order), dtype=np.int32)
        into[free] = free[_merge(size[free].astype(np.float64), colour[free], textures, picture is not None)]
        kinds = into[kinds]
    _, dense = np.unique(kinds, return_inverse=True)
    return dense.astype(np.int32)


def _colours(
    picture: np.ndarray, kinds: Int32[np.ndarray, "h w"], size: Int64[np.ndarray, "k"]
) -> Float64[np.ndarray, "k 3"]:
    """Return the mean colour of each kind, in CIELAB."""
    import cv2

    with plain_opencv():
        small = cv2.resize(to_rgb8(picture), kinds.shape[::-1], interpolation=cv2.INTER_AREA)
        lab = np.asarray(cv2.cvtColor(small.astype(np.float32) / np.float32(255), cv2.COLOR_RGB2LAB))
    flat = kinds.reshape(-1)
    sums = [np.bincount(flat, lab[..., channel].reshape(-1), size.size) for channel in range(3)]
    return np.stack(sums, axis=1) / np.maximum(size, 1)[:, None]


def _merge(
    size: Float64[np.ndarray, "k"], colour: Float64[np.ndarray, "k 3"], most: int, coloured: bool
) -> Int64[np.ndarray, "k"]:
    """Merge kinds until at most `most` are left; return the kind that each goes into."""
    into = np.arange(size.size)
    alive = np.sort(np.argsort(-size, kind="stable")[:MOST_COMPARED])
    for each in np.setdiff1d(into, alive).tolist():
        into[each] = alive[np.square(colour[alive] - colour[each]).sum(axis=1).argmin()]
    size = np.bincount(into, size, into.size)
    colour = colour.copy()
    while alive.size > most:
        apart = np.square(colour[alive][:, None] - colour[alive]).sum(axis=2) if coloured else 1.0
        cost = apart * np.outer(size[alive], size[alive]) / np.add.outer(size[alive], size[alive])
        np.fill_diagonal(cost, np.inf)
        one, other = (int(alive[each]) for each in divmod(int(cost.argmin()), alive.size))
        stays, goes = (one, other) if size[one] >= size[other] else (other, one)
        both = size[stays] + size[goes]
        colour[stays] = (size[stays] * colour[stays] + size[goes] * colour[goes]) / both
        size[stays] = both
        into[into == goes] = stays
        alive = alive[alive != goes]
    return into
