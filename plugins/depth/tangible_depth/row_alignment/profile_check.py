"""The row-alignment test by profiles: does the mean grey of each row occur at the same height in the other view?

Matching along rows may take one course of bricks for the next; their profiles lie at different heights.
"""

import numpy as np
from jaxtyping import Float64, UInt8

from ..search.pairs import Pair

REACH = 1 / 6
"""Largest shift tried up and down, as a share of the picture's height."""
NEAR = 1 / 200
"""Largest accepted shift, as a share of the picture's height and at least 2 px: other tests correct it."""
LEAST_BETTER = 0.05
"""Smallest gain in correlation of another height that fails the test."""
LESS_LEFT = 0.6
"""Share of the unexplained part at the own height below which another height fails the test too: courses repeat."""
NO_BETTER = 0.995
"""Correlation at the own height that always passes."""
SLOW = 1 / 8
"""Wavelength, as a share of the height, from which changes of grey are ignored: light, and the views' borders."""


def rows_match_elsewhere(pair: Pair) -> bool:
    """Test whether the rows as a whole correlate better with rows at another height of the right view."""
    height = pair.left.shape[0]
    reach, near = int(REACH * height), max(2, round(NEAR * height))
    if reach <= near:
        return False
    left, right = (_profile(view) for view in pair)
    scores = _correlations(left, right, reach)
    best, own = float(scores.max()), float(scores[reach - near : reach + near + 1].max())
    return own < NO_BETTER and (best > own + LEAST_BETTER or 1 - best < LESS_LEFT * (1 - own))


def _profile(view: UInt8[np.ndarray, "h w"]) -> Float64[np.ndarray, "h"]:
    """Return the mean grey of each row, without slow changes."""
    import cv2

    means = cv2.reduce(view, 1, cv2.REDUCE_SUM, dtype=cv2.CV_32S)[:, 0] / view.shape[1]
    half = max(3, int(SLOW * len(means)))
    sums = np.concatenate([[0.0], np.cumsum(np.pad(means, half, mode="edge"))])
    return means - (sums[2 * half + 1 :] - sums[: -2 * half - 1]) / (2 * half + 1)


def _correlations(
    left: Float64[np.ndarray, "h"], right: Float64[np.ndarray, "h"], reach: int
) -> Float64[np.ndarray, "shifts"]:
    """Correlate the left profile with the right one -reach to reach rows further down, over their common rows."""
    nothing = np.zeros(reach)
    windows = np.lib.stride_tricks.sliding_window_view(np.concatenate([nothing, right, nothing]), len(left))
    both = np.einsum("sh,h->s", windows, left)
    # Downwards the lowest left rows and the uppermost right rows have no partner; upwards it is the other way round.
    ours, theirs = (np.cumsum(each**2) for each in (left, right))
    steps = np.arange(1, reach + 1)
    down = ours[-1 - steps] * (theirs[-1] - theirs[steps - 1])
    up = theirs[-1 - steps] * (ours[-1] - ours[steps - 1])
    energy = np.concatenate([up[::-1], [ours[-1] * theirs[-1]], down])
    return both / np.sqrt(np.maximum(energy, np.finfo(np.float64).tiny))
