"""How alike two windows are."""

import numpy as np
from jaxtyping import Float


def matching_value(one: Float[np.ndarray, "*window"], other: Float[np.ndarray, "*window"]) -> float:
    """Zero-mean normalised cross-correlation of two windows of one shape, -1..1; NaN where either is flat.

    c = sum (p - mean p)(q - mean q) / sqrt(sum (p - mean p)^2 sum (q - mean q)^2); unchanged by gain and offset.
    Source: the report "Tangible Images", eq. 2.14.
    """
    p, q = (np.asarray(each, np.float64) - np.mean(each, dtype=np.float64) for each in (one, other))
    spread = float(np.sqrt(np.sum(p * p) * np.sum(q * q)))
    return float(np.clip(np.sum(p * q) / spread, -1, 1)) if spread > 0 else float("nan")


def squared_difference(one: Float[np.ndarray, "*window"], other: Float[np.ndarray, "*window"]) -> float:
    """Sum of squared differences of two windows of one shape, 0 where they are equal.

    Source: the report "Tangible Images", ch. 2.
    """
    return float(np.sum((np.asarray(one, np.float64) - np.asarray(other, np.float64)) ** 2))
