"""The classes of cells: a fine division, discriminants that tell its clusters apart, then joining."""

import logging
from collections.abc import Iterable
from itertools import accumulate
from math import isfinite
from typing import Literal, NamedTuple

import numpy as np
from jaxtyping import Float64, Int32

from tangible_core.plugins.notes import note

from ..features.features import Features
from .joining import Step

log: logging.Logger = logging.getLogger(__name__)

PRINCIPAL_AXES = 14
"""The number of principal axes along which cells are divided."""
HALF_WHITE = 0.25
"""The power of its variance that divides a principal axis: half way between none, 0, and full whitening, 0.5."""
MOST_GUESSED = 8
"""The largest number of segments under `auto`."""
ESTIMATE_CONFIDENCE = 0.2, 1.1, 0.97
"""The confidence of an estimate without any lead, its growth per unit of lead, and its maximum.

They are fitted to the share of right estimates on mosaics.
"""
FINAL_ROUNDS = 8
"""The number of rounds in which the final classes are fitted again and settle with their neighbours."""


class Effort(NamedTuple):
    """The initial number of clusters, and the number of joinings with recomputed discriminants."""

    each: int
    """Initial clusters for each segment."""
    besides: int
    """Initial clusters on top of these."""
    last: int
    """Joinings with recomputed discriminants, before the number of segments is reached."""


EFFORTS = {"fast": Effort(2, 2, 2), "balanced": Effort(3, 4, 8)}


def classes(
    features: Features, segments: int | Literal["auto"], effort: Literal["fast", "balanced"]
) -> tuple[Int32[np.ndarray, "m"], Float64[np.ndarray, "a d"]]:
    """Classify the cells of the middle windows.

    Returns: the class of each cell, and the axes along which classes differ, none for a single class.
    """
    from .discriminants import principal_axes
    from .dividing import divide
    from .joining import FEW_POWER, MANY, MANY_POWER, axes_between, join_clusters
    from .neighbourhood import refit_labels
    from .planes import combine_planes

    spent, (planes, shape) = EFFORTS[effort], features.middle
    most = MOST_GUESSED if segments == "auto" else segments
    rotated = combine_planes(principal_axes(features.wide.planes, PRINCIPAL_AXES, HALF_WHITE), features.wide.planes)
    labels = _resample_labels(divide(rotated, spent.each * most + spent.besides), features.wide.shape, shape)
    power = MANY_POWER if segments != "auto" and segments >= MANY else FEW_POWER
    steps = join_clusters(planes, labels, shape, most + spent.last, power)
    labels = (
        _clearest_division(steps)
        if segments == "auto"
        else next(each.labels for each in steps if each.clusters <= segments)
    )
    axes = axes_between(planes, labels, shape)
    return (
        refit_labels(combine_planes(axes, planes), labels, shape, FINAL_ROUNDS, 1) if len(axes) else labels * 0
    ), axes


def _resample_labels(
    labels: Int32[np.ndarray, "l"], shape: tuple[int, int], to: tuple[int, int]
) -> Int32[np.ndarray, "m"]:
    """Sample labels of a coarse grid on a finer one."""
    rows, columns = (((np.arange(n) + 0.5) * side / n).astype(int) for side, n in zip(shape, to, strict=True))
    return labels.reshape(shape)[np.ix_(rows, columns)].ravel()


def _clearest_division(steps: Iterable[Step]) -> Int32[np.ndarray, "m"]:
    """Return the division whose next joining costs the most, relative to the dearest joining before it."""
    every = list(steps)
    dearest = accumulate((each.cost if isfinite(each.cost) else 0.0 for each in every), max)
    leaps = {
        after.clusters: (after.cost / before, after)
        for before, after in zip(dearest, every[1:], strict=False)
        if 2 <= after.clusters <= MOST_GUESSED and min(before, after.cost) > 0
    }
    if not leaps:
        return every[-1].labels
    best, *others = sorted(leaps, key=lambda count: -leaps[count][0])
    lead = 1 - leaps[others[0]][0] / leaps[best][0] if others else 0.0
    least, slope, most = ESTIMATE_CONFIDENCE
    note(
        log,
        f"segments: {best}, estimated with confidence {min(most, least + slope * lead):.2f}: joining two of them costs "
        f"{leaps[best][0]:.1f} times as much as any joining before",
    )
    return leaps[best][1].labels
