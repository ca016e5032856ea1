"""Parts merged and opened until fingers can read them."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Int32

from tangible_core.data import PartMap, SegmentMap
from tangible_core.parts import SimplifyChoice, find_parts

from ..grid import Grid, on_grid
from ..widths import Widths, measure
from .opening import NOISY, Opening
from .outcome import find_failures, note_outcome
from .textures import count_textures, texture_kinds

COARSE = 2
"""Side of a coarse cell, in cells: most of the work is done on coarse cells, in a quarter of the time."""
CLEARLY = 0.8
"""Share of a bound below which a width on coarse cells fails for certain, despite their error."""


def simplify(
    parts: PartMap,
    width_m: float,
    choice: SimplifyChoice,
    names: Sequence[str] = (),
    picture: np.ndarray | None = None,
    front: Sequence[int] = (),
) -> PartMap:
    """Simplify parts until fingers can read them; they keep their numbers, on a grid that may be another one.

    Parts that pass are returned unchanged, on the grid of `on_grid`, so that simplifying twice is the same as once.
    Otherwise, on cells of an eighth to a quarter of a millimetre, parts without a name that are most alike in colour
    become one texture until there are `choice.textures`. Then places narrower than `choice.gap_m` and parts that hold
    no disc of `choice.part_m` go to their neighbours, again and again until all parts pass. A part that vanished has
    no pixel. Parts that became one texture have one segment.
    names: of parts, by number; parts with a name stay apart. picture: of the parts' size, for its colours. front:
    numbers of the parts of the figure, which become textures of their own.
    Notes name the named parts that vanished, the parts in several pieces and, if it cannot pass, the cure.
    Raises: GeometryError if width_m is not positive.
    """
    grid = on_grid(parts, width_m, worked=True)
    coarse, coarse_m = _coarsen(grid.parts.labels), COARSE * grid.pitch_m
    coarse_widths = measure(coarse, coarse_m, choice.gap_m, quick=True)
    if not _clearly_fails(grid.parts, coarse_widths, coarse_m, choice, names):
        whole = on_grid(parts, width_m)
        widths = measure(whole.parts.labels, whole.pitch_m, choice.gap_m)
        if not find_failures(whole.parts, widths, choice, names):
            return whole.parts
    kinds = texture_kinds(grid.parts, names, choice.textures, picture, front)
    named = np.zeros(int(kinds.max()) + 1, np.bool_)
    named[[kind for kind, name in zip(kinds.tolist(), names, strict=False) if name]] = True
    labels, shape = kinds[grid.parts.labels], grid.parts.labels.shape
    rough, _ = Opening(choice, named, coarse_m, picture).run(kinds[coarse], rough=True)
    labels = np.where(_refine(rough != kinds[coarse], shape), _refine(rough, shape), labels)
    labels, widths = Opening(choice, named, grid.pitch_m, picture).run(labels)
    simplified = _number_pieces(grid.parts, labels, kinds)
    note_outcome(grid.parts, Grid(simplified, grid.pitch_m), widths, width_m, choice, names)
    return simplified


def _coarsen(labels: Int32[np.ndarray, "h w"]) -> Int32[np.ndarray, "r c"]:
    return np.ascontiguousarray(labels[::COARSE, ::COARSE])


def _refine(coarse: np.ndarray, shape: tuple[int, int]) -> np.ndarray:
    return coarse.repeat(COARSE, 0).repeat(COARSE, 1)[: shape[0], : shape[1]]


def _clearly_fails(parts: PartMap, wide: Widths, pitch_m: float, choice: SimplifyChoice, names: Sequence[str]) -> bool:
    """Test whether parts fail by so much that their widths on coarse cells show it."""
    small = wide.size[wide.disc_m < CLEARLY * choice.part_m].sum() > NOISY * wide.size.sum()
    large = 2 * (choice.gap_m / pitch_m) ** 2
    narrow = any(place.width_m < CLEARLY * choice.gap_m and place.size > large for place in wide.places)
    return bool(small) or narrow or count_textures(parts, names) > choice.textures


def _number_pieces(parts: PartMap, labels: Int32[np.ndarray, "h w"], kinds: Int32[np.ndarray, "n"]) -> PartMap:
    """Give each connected piece of a kind the number of the part of this kind that covers most of it.

    A piece that no part of its kind covers gets the largest one's number. Segments are those of the largest part of
    each kind.
    """
    before, count = parts.labels, parts.count
    size = np.bincount(before.reshape(-1), minlength=count)
    largest = np.zeros(int(kinds.max()) + 1, np.int64)
    by_size = np.argsort(size, kind="stable")
    largest[kinds[by_size]] = by_size
    pieces = find_parts(SegmentMap(labels))
    same = kinds[before] == labels
    pairs, shared = np.unique(pieces.labels[same].astype(np.int64) * count + before[same], return_counts=True)
    piece, part = np.divmod(pairs, count)
    order = np.lexsort((-part, shared))
    number = largest[np.array(pieces.segments)]
    number[piece[order]] = part[order]
    of_part: list[int] = largest[kinds].tolist()
    segments = tuple(parts.segments[each] for each in of_part)
    return PartMap(number.astype(np.int32)[pieces.labels], segments)
