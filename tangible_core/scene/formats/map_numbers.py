"""The numbers of a height map: marks for no data that nothing declares, and what 32 bits hold of the others."""

import re

import numpy as np
from jaxtyping import Float, Float32

# Numbers that no one measures: -9999, 99999.9, the least of 16 bits, -10000.
NINES = re.compile(r"-?9{3,}(\.9+)?|-32768|-32767|-10{4,}")
# The largest whole numbers of 16 bits, which a map that is stretched to all of them reaches as well.
LIMITS = (32767, 65535)
# Numbers are marks beyond this magnitude where they are this many times those of the other heights, such as 1e20.
HUGE, TIMES = 1e9, 1e3
SPANS = 0.1  # least gap between such a number and the other heights, of the range of these
# This gap for a number of LIMITS, and for any other one: a lone summit or a tower stands on slopes or on its own.
LIMIT_SPANS, ANY_SPANS = 5.0, 20.0
# Magnitude of numbers, in their range, from which 32 bits leave fewer than 16 bits to their differences.
RESOLVED = 1 << 8
# The fewest other heights, so that a map of labels has none, and the fewest cells of a number that looks like any.
FEWEST_LEVELS, FEWEST_CELLS = 16, 2


def undeclared_nodata(heights: Float[np.ndarray, "h w"]) -> list[np.floating]:
    """Return the numbers that stand alone, far below or above all other heights, as no ground does.

    >>> undeclared_nodata(np.float32([[-9999, 100], [101, 102]]))
    [np.float32(-9999.0)]
    """
    marks = list[np.floating]()
    finite_values = heights[np.isfinite(heights)]
    while finite_values.size:
        ends = finite_values.min(), finite_values.max()
        inner = finite_values[(finite_values > ends[0]) & (finite_values < ends[1])]
        alone = [
            end for end, other in zip(ends, ends[::-1], strict=True)
            if end != other and _is_mark(end, finite_values, inner if inner.size else np.array([other]))
        ]  # fmt: skip
        if not alone:
            break
        marks += alone
        finite_values = finite_values[~np.isin(finite_values, alone)]
    return marks


def _is_mark(number: np.floating, known: Float[np.ndarray, "n"], others: Float[np.ndarray, "m"]) -> bool:
    value, low, high = float(number), float(others.min()), float(others.max())
    gap, span = max(low - value, value - high), high - low
    is_huge = abs(value) >= max(HUGE, TIMES * max(abs(low), abs(high)))
    if is_huge or NINES.fullmatch(number_text(number)):
        return gap > SPANS * span
    if gap <= (LIMIT_SPANS if value in LIMITS else ANY_SPANS) * span:
        return False
    return int(np.count_nonzero(known == number)) >= FEWEST_CELLS and np.unique(others).size >= FEWEST_LEVELS


def is_nodata(values: np.ndarray, nodata: float) -> np.ndarray:
    """Return True where a value is the one for no data that a file states; of floating point also in few digits."""
    if values.dtype.kind != "f":
        return values == nodata
    return np.isclose(values, np.array(nodata).astype(values.dtype), rtol=1e-5 if abs(nodata) > 1e30 else 0, atol=0)


def number_text(number: np.floating) -> str:
    """Return the shortest text that is this number again at its precision.

    >>> number_text(np.float32(-9999)), number_text(np.float32(3.4028235e38)), number_text(np.float32(0.1))
    ('-9999', '3.4028235e+38', '0.1')
    """
    return str(number).removesuffix(".0")


def in_32_bits(heights: Float[np.ndarray, "h w"]) -> tuple[Float32[np.ndarray, "h w"], float]:
    """Return heights in 32 bits, NaN where these end, and the offset that was taken off before."""
    # The offset is 0 unless it would drown the differences: heights of planets are small beside their radius.
    if heights.dtype == np.float32:
        return heights, 0.0
    finite_values = heights[np.abs(heights) <= np.finfo(np.float32).max]
    low, high = (float(finite_values.min()), float(finite_values.max())) if finite_values.size else (0.0, 0.0)
    drowned = 0 < RESOLVED * (high - low) < max(-low, high) and np.any(
        finite_values.astype(np.float32) != finite_values
    )
    offset = low if drowned else 0.0
    with np.errstate(over="ignore"):
        numbers = (heights - offset).astype(np.float32)
    return np.where(np.isfinite(numbers), numbers, np.float32(np.nan)), offset
