"""A look across the rows: whether the mean grey of each row is found again at its own height in the other view.

What a look along rows alone takes for a match, such as one course of bricks for the next, lies at another height here.
"""

import numpy as np
from jaxtyping import Float64, UInt8

from ..search.pairs import Pair

REACH = 1 / 6
"""How far up and down is looked, in heights of the picture."""
NEAR = 1 / 200
"""Heights of the picture, 2 px at least, up to which a view may lie lower or higher: that is put right otherwise."""
LEAST_BETTER, LESS_LEFT, NO_BETTER = 0.05, 0.6, 0.995
"""By how much another height must correlate better; or the share that it must leave of what their own heights leave
unexplained, as where courses repeat; correlation from which nothing is better."""
SLOW = 1 / 8
"""Changes of grey over this share of the height are light, and what one view shows beyond the other."""


def rows_lie_elsewhere(pair: Pair) -> bool:
    """Whether the rows as a whole look more like rows at another height of the right view than like their own."""
    height = pair.left.shape[0]
    reach, near = int(REACH * height), max(2, round(NEAR * height))
    if reach <= near:
        return False
    left, right = (_profile(view) for view in pair)
    scores = _correlations(left, right, reach)
    best, own = float(scores.max()), float(scores[reach - near : reach + near + 1].max())
    return own < NO_BETTER and (best > own + LEAST_BETTER or 1 - best < LESS_LEFT * (1 - own))


def _profile(view: UInt8[np.ndarray, "h w"]) -> Float64[np.ndarray, "h"]:
    """Mean of each row, without its slow changes."""
    import cv2

    means = cv2.reduce(view, 1, cv2.REDUCE_SUM, dtype=cv2.CV_32S)[:, 0] / view.shape[1]
    half = max(3, int(SLOW * len(means)))
    sums = np.concatenate([[0.0], np.cumsum(np.pad(means, half, mode="edge"))])
    return means - (sums[2 * half + 1 :] - sums[: -2 * half - 1]) / (2 * half + 1)


def _correlations(
    left: Float64[np.ndarray, "h"], right: Float64[np.ndarray, "h"], reach: int
) -> Float64[np.ndarray, "shifts"]:
    """Of the left rows with the right ones -reach to reach rows further down, over the rows that both have."""
    nothing = np.zeros(reach)
    windows = np.lib.stride_tricks.sliding_window_view(np.concatenate([nothing, right, nothing]), len(left))
    both = np.einsum("sh,h->s", windows, left)
    # Of the left rows those above the lowest ones count, and of the right rows the others; the other way round upwards.
    ours, theirs = (np.cumsum(each**2) for each in (left, right))
    steps = np.arange(1, reach + 1)
    down = ours[-1 - steps] * (theirs[-1] - theirs[steps - 1])
    up = theirs[-1 - steps] * (ours[-1] - ours[steps - 1])
    energy = np.concatenate([up[::-1], [ours[-1] * theirs[-1]], down])
    return both / np.sqrt(np.maximum(energy, np.finfo(np.float64).tiny))
