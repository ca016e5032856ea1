"""The classes of cells: a fine division, discriminants that tell its clusters apart, then joining."""

from typing import Literal, NamedTuple

import numpy as np
from jaxtyping import Float64, Int32

from ..features.features import Features, Window
from .counting import largest_number, likeliest_division
from .discriminants import principal_axes
from .dividing import divide
from .joining import FEW_POWER, MANY, MANY_POWER, axes_between, join_clusters, project
from .neighbourhood import interior_shares, refit_labels
from .planes import combine_planes

PRINCIPAL_AXES = 14
HALF_WHITE = 0.25
"""The power of its variance that divides a principal axis: half way between none, 0, and full whitening, 0.5."""
FINAL_ROUNDS = 8
"""The number of rounds in which the final classes are fitted again and settle with their neighbours."""


class Effort(NamedTuple):
    """The initial number of clusters, and the number of joinings with recomputed discriminants."""

    per_segment: int
    besides: int
    last: int
    """Joinings with recomputed discriminants, before the number of segments is reached."""


EFFORTS = {"fast": Effort(2, 2, 2), "balanced": Effort(3, 4, 8)}


def classes(
    features: Features,
    network_window: Window | None,
    segments: int | Literal["auto"],
    effort: Literal["fast", "balanced"],
) -> tuple[Int32[np.ndarray, "m"], Float64[np.ndarray, "a d"]]:
    """Classify the cells of the middle windows; return each cell's class, and the axes along which classes differ."""
    counts, (planes, shape) = EFFORTS[effort], features.middle
    most = largest_number(planes.shape[1]) if segments == "auto" else segments
    principal_planes = combine_planes(
        principal_axes(features.wide.planes, PRINCIPAL_AXES, HALF_WHITE), features.wide.planes
    )
    wide = divide(principal_planes, counts.per_segment * most + counts.besides).reshape(features.wide.shape)
    rows, columns = (((np.arange(n) + 0.5) * side / n).astype(int) for side, n in zip(wide.shape, shape, strict=True))
    labels = wide[np.ix_(rows, columns)].ravel()
    power = MANY_POWER if segments == "auto" or segments >= MANY else FEW_POWER
    # What `learned_values` makes of these cells counts as much as the features in joining.
    sets = [planes] if network_window is None else [planes, network_window.planes]
    steps = join_clusters(sets, labels, shape, most + counts.last, power)
    labels = (
        likeliest_division(step for step in steps if step.clusters <= most + counts.last)
        if segments == "auto"
        else next(step.labels for step in steps if step.clusters <= segments)
    )
    shares = interior_shares(labels, shape)
    axes = [axes_between(planes, labels, shares) for planes in sets]
    if not len(axes[0]):
        return labels * 0, axes[0]
    return refit_labels(project(axes, sets)[0], labels, shape, FINAL_ROUNDS, 1), axes[0]
