"""The classes of cells: a fine division, discriminants that tell its clusters apart, then joining."""

import logging
from collections.abc import Iterable
from itertools import pairwise
from typing import Literal, NamedTuple

import numpy as np
from jaxtyping import Float64, Int32

from tangible_core.plugins.notes import note

from ..features.features import Features
from .joining import Step

log = logging.getLogger(__name__)

PRINCIPAL_AXES = 14
HALF_WHITE = 0.25
"""Power of its variance by which a principal axis is divided: between none and full whitening, which is 0.5."""
AXES = 20
"""Discriminants that are kept."""
MOST_GUESSED = 8
"""What `segments: auto` stops at."""
MOST_WORTH = 0.5
"""No rule carries over from some textures to others: even a clear guess is right every second time."""
FINAL_ROUNDS = 8


class Effort(NamedTuple):
    """Clusters to begin with, a segment and besides; and rounds of settling after each joining."""

    each: int
    besides: int
    votes: int


EFFORTS = {"fast": Effort(2, 4, 0), "balanced": Effort(3, 4, 1)}


def classes(
    found: Features, segments: int | Literal["auto"], effort: Literal["fast", "balanced"]
) -> tuple[Int32[np.ndarray, "m"], Float64[np.ndarray, "a d"]]:
    """The class of each cell of the middle windows, and the axes along which classes differ."""
    from .discriminants import discriminant_axes, principal_axes, scatters
    from .dividing import divided, members
    from .joining import joining
    from .neighbourhood import INSIDE_CELLS, refitted, smoothed
    from .planes import mixed

    spent, shape = EFFORTS[effort], found.middle.shape
    most = MOST_GUESSED if segments == "auto" else segments
    rotated = mixed(principal_axes(found.wide.planes, PRINCIPAL_AXES, HALF_WHITE), found.wide.planes)
    labels = _spread(divided(rotated, spent.each * most + spent.besides), found.wide.shape, shape)
    own = members(labels, int(labels.max()) + 1)
    fit = scatters(found.middle.planes, own * smoothed(own, shape, INSIDE_CELLS) ** 2)
    axes = discriminant_axes(fit, AXES)
    planes = mixed(axes, found.middle.planes)
    steps = joining(planes, refitted(planes, labels, shape, 2, 1), shape, spent.votes)
    labels = _guessed(steps) if segments == "auto" else next(each.labels for each in steps if each.clusters <= segments)
    return refitted(planes, labels, shape, FINAL_ROUNDS, 1), axes


def _spread(labels: Int32[np.ndarray, "l"], shape: tuple[int, int], to: tuple[int, int]) -> Int32[np.ndarray, "m"]:
    """Labels of a coarse grid, on a finer one."""
    rows, columns = (((np.arange(n) + 0.5) * side / n).astype(int) for side, n in zip(shape, to, strict=True))
    return labels.reshape(shape)[np.ix_(rows, columns)].ravel()


def _guessed(steps: Iterable[Step]) -> Int32[np.ndarray, "m"]:
    """The division whose next joining costs the most, against the joining before."""
    every = list(steps)
    leaps = {
        after.clusters: (after.cost / before.cost, after)
        for before, after in pairwise(every)
        if 2 <= after.clusters <= MOST_GUESSED and before.cost > 0
    }
    if not leaps:
        return every[-1].labels
    best, *others = sorted(leaps, key=lambda count: -leaps[count][0])
    worth = min(MOST_WORTH, 1 - max((leaps[count][0] for count in others), default=0.0) / leaps[best][0])
    note(
        log,
        f"segments: {best}, a guess worth {worth:.2f}: to join two of them costs {leaps[best][0]:.1f} times as much as "
        "the joining before",
    )
    return leaps[best][1].labels
