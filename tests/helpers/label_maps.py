"""How well labels agree."""

import numpy as np

from tangible_bench.metrics.segments import adjusted_rand_index, contingency


def rand_index(one: np.ndarray, other: np.ndarray) -> float:
    """Adjusted Rand index of two label maps, or of two rows of labels."""
    return adjusted_rand_index(contingency(np.atleast_2d(one), np.atleast_2d(other)))
