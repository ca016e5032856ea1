"""The envelopes of heights, compiled. Imports numba: its users import it inside their verbs."""

# pyright: basic

from ..compiled.compiling import KERNEL, inner, njit


@inner()
def _lower_row(row, other, shift, rise):
    """Lower each value of a row to that of the other row, `shift` columns away, plus a rise."""
    left, right = max(0, -shift), max(0, shift)
    low, high = row[left : row.size - right], other[right : other.size - left]
    for x in range(min(low.size, high.size)):  # an index that cannot be negative is vectorised
        bound = high[x] + rise
        low[x] = bound if bound < low[x] else low[x]


@inner()
def _lower_along(one, other, rise, backwards):
    """Lower each value of two rows to that of its neighbour before it, plus a rise; both at once, for speed."""
    last = one.size - 1
    start = last if backwards else 0
    step = -1 if backwards else 1
    first, second = one[start], other[start]
    for count in range(one.size):
        x = start + step * count
        first, second = first + rise, second + rise
        first = one[x] if one[x] < first else first
        second = other[x] if other[x] < second else second
        one[x], other[x] = first, second


@njit(**KERNEL)
def lower(heights, straight, diagonal, knight):
    """Lower two maps (2, h, w), in place, to the highest surfaces that rise no faster to cells (0|1, 1|2) away."""
    rows = heights.shape[1]
    # Two passes suffice, forwards and backwards.
    for backwards in (False, True):
        for count in range(rows):
            y = rows - 1 - count if backwards else count
            before = y + 1 if backwards else y - 1
            second = y + 2 if backwards else y - 2
            for k in range(2):
                row = heights[k, y]
                if 0 <= before < rows:
                    other = heights[k, before]
                    _lower_row(row, other, 0, straight)
                    for shift in (-1, 1):
                        _lower_row(row, other, shift, diagonal)
                        _lower_row(row, other, 2 * shift, knight)
                if 0 <= second < rows:
                    for shift in (-1, 1):
                        _lower_row(row, heights[k, second], shift, knight)
            _lower_along(heights[0, y], heights[1, y], straight, backwards)
