"""Which part of a picture the tip is on, by the part's name; looked up beside the force loop, never in it."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float64, Int32

from ..data import HapticSurface, Vector
from .recording import Recording

Places = Float64[np.ndarray, "n 3"]


class PartFelt(NamedTuple):
    """How a part was felt."""

    number: int
    name: str
    """Empty where nobody gave it one."""
    share: float
    """Of the time in contact, in which the tip was on it."""
    peak_force_n: float


def part_under(surface: HapticSurface, position_m: Vector) -> str:
    """What the part under a tip is called, touched or not; empty beside the surface, and where that has no parts."""
    if surface.names is None:
        return ""
    (number,) = _parts_under(surface, np.array([position_m], np.float64)).tolist()
    return "" if number < 0 else called(number, surface.names[number])


def called(number: int, name: str) -> str:
    """A part by its name, or by its number where it has none."""
    return name or f"part {number}"


def parts_felt(felt: Recording, surface: HapticSurface) -> tuple[PartFelt, ...]:
    """Every part that was touched, the longest touched first; none where the surface has no parts."""
    force_n = np.linalg.norm(felt.force_n, axis=1)
    touching = force_n > 0
    if surface.names is None or not touching.any():
        return ()
    under, force_n = _parts_under(surface, felt.position_m[touching]), force_n[touching]
    numbers, ticks = np.unique(under[under >= 0], return_counts=True)
    order = np.argsort(-ticks, kind="stable")
    return tuple(
        PartFelt(number, surface.names[number], count / touching.sum(), float(force_n[under == number].max()))
        for number, count in zip(numbers[order].tolist(), ticks[order].tolist(), strict=True)
    )


def _parts_under(surface: HapticSurface, at_m: Places) -> Int32[np.ndarray, " n"]:
    """The number of the part under each place, -1 beside the surface."""
    labels = surface.labels
    assert labels is not None
    (rows, columns), (width_m, length_m) = labels.shape, surface.extent_m
    across, along = 0.5 + at_m[:, 0] / width_m, 0.5 - at_m[:, 1] / length_m
    over = (across >= 0) & (across <= 1) & (along >= 0) & (along <= 1)
    column = np.minimum((np.where(over, across, 0) * columns).astype(np.intp), columns - 1)
    row = np.minimum((np.where(over, along, 0) * rows).astype(np.intp), rows - 1)
    return np.where(over, labels[row, column], np.int32(-1))
