"""Parts merged and opened until fingers can read them, and notes on what still fails."""

import logging
from collections.abc import Sequence
from math import ceil
from typing import NamedTuple

import numpy as np
from jaxtyping import Int32

from tangible_core.data import PartMap, SegmentMap
from tangible_core.parts import SimplifyChoice, find_parts
from tangible_core.plugins import note

from ..grid import Grid, on_grid
from ..widths import ROUND_OFF, Widths, measure
from ..words.places import describe_part, join_texts, millimetres
from .large import count_textures, texture_kinds
from .opening import NOISY, Opening, too_small

log: logging.Logger = logging.getLogger(__name__)
SIZE_STEP = 1.1  # ratio of one size to the next in the search for one that passes
MAX_STEPS = 40  # sizes that are tried: up to 41 times the width


class Failures(NamedTuple):
    """Counts of what does not pass."""

    small: int
    narrow: int
    textures: int


def find_failures(parts: PartMap, wide: Widths, choice: SimplifyChoice, names: Sequence[str]) -> Failures | None:
    """Count what does not pass; None if everything passes."""
    small = int(np.count_nonzero(too_small(wide, choice)))
    failures = Failures(small, len(wide.places), max(0, count_textures(parts, names) - choice.textures))
    return failures if any(failures) else None


def note_outcome(
    whole: PartMap, simplified: Grid, wide: Widths, width_m: float, choice: SimplifyChoice, names: Sequence[str]
) -> None:
    """Note which named parts vanished, which parts are in several pieces, and whether the simplified parts pass."""
    count = whole.count
    before, after = (
        np.bincount(part_map.labels.reshape(-1), minlength=count) for part_map in (whole, simplified.parts)
    )
    gone = [n for n in np.flatnonzero((before > 0) & (after == 0)).tolist() if n < len(names) and names[n]]
    if gone:
        note(log, _vanished_message(gone, Grid(whole, simplified.pitch_m), width_m, choice, names), logging.WARNING)
    part_of_piece = simplified.parts.labels.reshape(-1)[np.unique(wide.pieces.reshape(-1), return_index=True)[1]]
    pieces = np.bincount(part_of_piece, minlength=count)
    if split := [f"{describe_part(n, names)} in {pieces[n]}" for n in np.flatnonzero(pieces > 1).tolist()]:
        note(log, f"simplified parts in several pieces: {join_texts(split)}")
    if failures := find_failures(simplified.parts, wide, choice, names):
        note(log, _failure_message(failures, simplified, width_m, choice), logging.WARNING)


def _vanished_message(
    gone: Sequence[int], whole: Grid, width_m: float, choice: SimplifyChoice, names: Sequence[str]
) -> str:
    wide = measure(whole.parts.labels, whole.pitch_m, choice.gap_m)
    disc_m = np.zeros(whole.parts.count)
    np.maximum.at(disc_m, wide.part, wide.disc_m)
    small = disc_m < choice.part_m * (1 - ROUND_OFF)
    texts = [
        f"{describe_part(n, names)}, "
        + (f"in which a disc of {millimetres(float(disc_m[n]))} fits" if small[n] else "which is too narrow in places")
        for n in gone
    ]
    times = max(1.05, choice.part_m / float(disc_m[list(gone)].min()))
    return (
        f"merged into their neighbours, as too small or too narrow for a finger: {join_texts(texts)}; a disc of "
        f"{millimetres(choice.part_m)} must fit, and {millimetres(choice.gap_m)} are needed everywhere: make the whole "
        f"{ceil(1e3 * times * width_m)} mm wide (`workspace.width_m`), or have fewer and larger parts"
    )


def _failure_message(failures: Failures, grid: Grid, width_m: float, choice: SimplifyChoice) -> str:
    kinds = (
        (failures.small, f"{failures.small} too small"),
        (failures.narrow, f"{failures.narrow} places too narrow"),
        (failures.textures, f"{failures.textures} textures too many"),
    )
    reasons = join_texts([text for count, text in kinds if count])
    times = 0.0 if failures.textures else _find_scale(grid, choice)
    cure = f"make the whole {millimetres(width_m * times)} wide, or " if times else ""
    return f"fingers cannot read the simplified parts ({reasons}); {cure}have fewer and larger parts"


def _find_scale(grid: Grid, choice: SimplifyChoice) -> float:
    """Return the factor by which the whole must grow to pass, by trial in steps of a tenth; 0 if none does."""
    for times in (SIZE_STEP**step for step in range(MAX_STEPS)):
        wide = measure(grid.parts.labels, grid.pitch_m * times, choice.gap_m)
        if not wide.places and not too_small(wide, choice).any():
            return times
    return 0.0


COARSE = 2  # side of a coarse cell, in cells: a quarter of the time
# Share of a bound below which a width on coarse cells fails for certain, despite their error.
CLEARLY = 0.8


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
    coarse, coarse_m = np.ascontiguousarray(grid.parts.labels[::COARSE, ::COARSE]), COARSE * grid.pitch_m
    coarse_widths = measure(coarse, coarse_m, choice.gap_m, quick=True)
    if not _clearly_fails(grid.parts, coarse_widths, coarse_m, choice, names):
        whole = on_grid(parts, width_m)
        widths = measure(whole.parts.labels, whole.pitch_m, choice.gap_m)
        if not find_failures(whole.parts, widths, choice, names):
            return whole.parts
    kinds = texture_kinds(grid.parts, names, choice.textures, picture, front)
    is_named = np.zeros(int(kinds.max()) + 1, np.bool_)
    is_named[[kind for kind, name in zip(kinds.tolist(), names, strict=False) if name]] = True
    labels, shape = kinds[grid.parts.labels], grid.parts.labels.shape
    rough, _ = Opening(choice, is_named, coarse_m, picture).run(kinds[coarse], rough=True)
    labels = np.where(_refine(rough != kinds[coarse], shape), _refine(rough, shape), labels)
    labels, widths = Opening(choice, is_named, grid.pitch_m, picture).run(labels)
    simplified = _number_pieces(grid.parts, labels, kinds)
    note_outcome(grid.parts, Grid(simplified, grid.pitch_m), widths, width_m, choice, names)
    return simplified


def _refine(coarse: np.ndarray, shape: tuple[int, int]) -> np.ndarray:
    return coarse.repeat(COARSE, 0).repeat(COARSE, 1)[: shape[0], : shape[1]]


def _clearly_fails(parts: PartMap, wide: Widths, pitch_m: float, choice: SimplifyChoice, names: Sequence[str]) -> bool:
    small = wide.size[wide.disc_m < CLEARLY * choice.part_m].sum() > NOISY * wide.size.sum()
    large = 2 * (choice.gap_m / pitch_m) ** 2
    narrow = any(place.width_m < CLEARLY * choice.gap_m and place.size > large for place in wide.places)
    return bool(small) or narrow or count_textures(parts, names) > choice.textures


def _number_pieces(parts: PartMap, labels: Int32[np.ndarray, "h w"], kinds: Int32[np.ndarray, "n"]) -> PartMap:
    """Give each connected piece of a kind the number of the part of this kind that covers most of it."""
    before, count = parts.labels, parts.count
    size = np.bincount(before.reshape(-1), minlength=count)
    largest = np.zeros(int(kinds.max()) + 1, np.int64)
    by_size = np.argsort(size, kind="stable")
    largest[kinds[by_size]] = by_size
    pieces = find_parts(SegmentMap(labels))
    same = kinds[before] == labels
    pairs, overlap = np.unique(pieces.labels[same].astype(np.int64) * count + before[same], return_counts=True)
    piece, part = np.divmod(pairs, count)
    order = np.lexsort((-part, overlap))
    number = largest[np.array(pieces.segments)]
    number[piece[order]] = part[order]
    of_part: list[int] = largest[kinds].tolist()
    segments = tuple(parts.segments[each] for each in of_part)
    return PartMap(number.astype(np.int32)[pieces.labels], segments)
