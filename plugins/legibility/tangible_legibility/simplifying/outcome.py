"""The outcome of a simplification: the bounds that still fail, and notes on lost and split parts with a cure."""

import logging
from collections.abc import Sequence
from math import ceil
from typing import NamedTuple

import numpy as np

from tangible_core.data import PartMap
from tangible_core.parts import SimplifyChoice
from tangible_core.plugins import note

from ..grid import Grid
from ..widths import ROUND_OFF, Widths, measure
from ..words.texts import describe_part, join_texts, millimetres
from .opening import too_small
from .textures import count_textures

log: logging.Logger = logging.getLogger(__name__)
SIZE_STEP = 1.1
"""Ratio of one size to the next when a size that would pass is searched."""
MOST_STEPS = 40
"""Sizes that are tried: up to 41 times the width."""


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
    whole: PartMap,
    simplified: Grid,
    wide: Widths,
    width_m: float,
    choice: SimplifyChoice,
    names: Sequence[str],
) -> None:
    """Note which named parts vanished, which parts are in several pieces, and whether the simplified parts pass."""
    count = whole.count
    before, after = (np.bincount(each.labels.reshape(-1), minlength=count) for each in (whole, simplified.parts))
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
    """Return a message on parts that vanished, with the size at which they would stay."""
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
    """Return a message on what still fails, with the size that would pass."""
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
    for times in (SIZE_STEP**step for step in range(MOST_STEPS)):
        wide = measure(grid.parts.labels, grid.pitch_m * times, choice.gap_m)
        if not wide.places and not too_small(wide, choice).any():
            return times
    return 0.0
