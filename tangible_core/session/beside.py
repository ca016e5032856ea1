"""Two recordings side by side: how the forces of one differ from those of the other, at the same places."""
# pyright: reportMissingTypeStubs=false

from typing import Any

import numpy as np
from jaxtyping import Float64

from ..errors import check_positive
from ..metrics.forces import force_errors
from .recording import Recording

NEAR_M = 1e-3
"""So near to each other, two places are one: no hand finds a place again more exactly."""
MOST_COMPARED = 100_000
"""Ticks; of a longer recording every so many are taken."""
SHOWN = ("ticks", "seconds", "contact_share", "median_contact_force_n", "peak_force_n", "work_j")
"""Figures of each recording that stand side by side."""


def beside(first: Recording, second: Recording, near_m: float = NEAR_M) -> dict[str, float]:
    """How much the second recording differs from the first, in numbers, by name, each with its unit.

    They are along similar paths, and may be of other speeds, lengths and times: each tick of the first is compared with
    the tick of the second that was nearest to its place, on the way in the most similar direction, as friction turns
    with the direction. A tick that has none within near_m is left out.

    Returns: the figures of `Recording.figures` of the first as `first_...`, of the second as `second_...`; `compared`,
    the ticks that have a partner, and `compared_share`, their share of those that were tried; `apart_m`, the median
    distance of partners; and of the second's forces against the first's, over the partners, what `force_errors` says:
    `error_n` is the root mean square of the difference over the ticks at which either is not zero. NaN where there is
    no partner.
    Raises: ConfigError if near_m is not positive.
    """
    check_positive("near_m", near_m)
    ours, theirs = (each.rows[np.isfinite(_places(each, near_m)).all(axis=1)] for each in (first, second))
    ours = ours[:: max(1, -(-len(ours) // MOST_COMPARED))]
    here, there = Recording(ours), Recording(theirs)
    partner, apart_m = _partners(here, there, near_m)
    near = apart_m <= near_m
    figures = {"first": first.figures(), "second": second.figures()}
    return {
        **{f"{which}_{name}": float(figures[which][name]) for name in SHOWN for which in figures},
        "compared": int(near.sum()),
        "compared_share": float(near.mean()) if near.size else 0.0,
        "apart_m": float(np.median(apart_m[near])) if near.any() else float("nan"),
        **force_errors(there.force_n[partner[near]], here.force_n[near]),
    }


def _partners(here: Recording, there: Recording, near_m: float) -> tuple[np.ndarray, Float64[np.ndarray, "n"]]:
    """Which tick of the second belongs to each of the first, and how far away it was."""
    if not len(here.rows) or not len(there.rows):
        return np.zeros(len(here.rows), np.int64), np.full(len(here.rows), np.inf)
    from scipy.spatial import KDTree

    tree: Any = KDTree(_places(there, near_m))
    partner: np.ndarray = tree.query(_places(here, near_m))[1]
    return partner, np.linalg.norm(here.position_m - there.position_m[partner], axis=1)


def _places(recording: Recording, near_m: float) -> Float64[np.ndarray, "n 6"]:
    """Places in steps of near_m, and the direction of motion: its reverse is as far away as two steps."""
    speed = np.linalg.norm(recording.velocity_m_per_s, axis=1, keepdims=True)
    return np.hstack([recording.position_m / near_m, recording.velocity_m_per_s / np.where(speed > 0, speed, 1)])
