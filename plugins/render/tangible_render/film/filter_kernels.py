"""`surface.jumps` and `surface.coefficients` row by row in float32, in loops that compile to vector instructions."""

import numpy as np
from numba import float32, types, uint8, void

from tangible_core.compiled import KERNEL, inner, njit

from ..surface.bilinear import HEIGHTS
from ..surface.coefficients import BORDER
from ..surface.jumps import BORDER_CELLS, BORDER_JUMP, JUMP, REACH
from .scratch import MARGIN, RING, TAPS

MASK = types.Array(uint8, 2, "C")
ROWS = types.Array(float32, 2, "C")
PAIRS = types.Array(float32, 3, "C")
LINE = types.Array(float32, 1, "C", readonly=True)
JUMPS, BORDER_JUMPS = np.float32(JUMP), np.float32(BORDER_JUMP)
SIXTH, HALF, NOTHING = np.float32(1 / 6), np.float32(0.5), np.float32(0.0)


@inner()
def _is_jump(a, b, c, d, e, f, g, rounding):
    """Return True if the fourth difference around d is large against the second ones up to two cells away."""
    before, left, here, right, after = (
        _second(a, b, c),
        _second(b, c, d),
        _second(c, d, e),
        _second(d, e, f),
        _second(e, f, g),
    )
    nearby = max(max(max(abs(left), abs(here)), max(abs(right), abs(before))), abs(after)) * JUMPS
    return abs((right - here) - (here - left)) > max(nearby, rounding)


@inner()
def _second(a, b, c):
    return (c - b) - (b - a)


@inner()
def _down(height_m, at, rounding):
    """Mark jumps down the columns, all at a time."""
    rows, columns = height_m.shape
    for row in range(3, rows - 3):
        for column in range(columns):
            at[row, column] |= _is_jump(
                height_m[row - 3, column],
                height_m[row - 2, column],
                height_m[row - 1, column],
                height_m[row, column],
                height_m[row + 1, column],
                height_m[row + 2, column],
                height_m[row + 3, column],
                rounding,
            )
    for column in range(columns):
        at[2, column] |= _at_border(height_m[:, column], 0, rounding)
        at[rows - 3, column] |= _at_border(height_m[:, column], rows - 5, rounding)


@inner()
def _along(height_m, at, rounding):
    """Mark jumps along the rows; indices start at 0, as numba does not vectorise ones that might be negative."""
    rows, columns = height_m.shape
    for row in range(rows):
        for i in range(columns - 6):
            at[row, i + 3] |= _is_jump(
                height_m[row, i],
                height_m[row, i + 1],
                height_m[row, i + 2],
                height_m[row, i + 3],
                height_m[row, i + 4],
                height_m[row, i + 5],
                height_m[row, i + 6],
                rounding,
            )
        at[row, 2] |= _at_border(height_m[row], 0, rounding)
        at[row, columns - 3] |= _at_border(height_m[row], columns - 5, rounding)


@inner()
def _at_border(line, first, rounding):
    """Return True if the outermost five cells, from `first` on, jump against those nearest to the border."""
    count = line.shape[0] - 2
    begin = 0 if first == 0 else max(count - BORDER_CELLS, 0)
    nearby = NOTHING
    for i in range(begin, min(begin + BORDER_CELLS, count)):
        nearby = max(nearby, abs(_second(line[i], line[i + 1], line[i + 2])))
    here = _second(line[first + 1], line[first + 2], line[first + 3])
    left, right = (
        _second(line[first], line[first + 1], line[first + 2]),
        _second(line[first + 2], line[first + 3], line[first + 4]),
    )
    return abs((right - here) - (here - left)) > max(nearby * BORDER_JUMPS, rounding)


@inner()
def _widen(at, wide, near):
    """Mark each jump and its two neighbours in each direction."""
    rows, columns = at.shape
    # Along rows first and then across: two passes of 2 REACH + 1 steps instead of their square.
    for row in range(rows):
        for i in range(columns):
            wide[row, i] = at[row, i]
        for step in range(1, REACH + 1):
            for i in range(columns - step):
                wide[row, i] |= at[row, i + step]
            for i in range(step, columns):
                wide[row, i] |= at[row, i - step]
    for row in range(near.shape[0]):
        line = near[row]
        for i in range(columns + 2 * RING):
            line[i] = 0
        if row == 0 or row == near.shape[0] - 1:
            continue
        inside = min(max(row - RING, 0), rows - 1)
        for other in range(max(inside - REACH, 0), min(inside + REACH + 1, rows)):
            for i in range(columns):
                line[RING + i] |= wide[other, i]
        for i in range(BORDER):
            line[RING - 1 - i], line[RING + columns + i] = line[RING], line[RING + columns - 1]


@inner()
def _continue(height_m, near, values):
    """Extend heights beyond each border by their odd reflection, or level where they jump at the border."""
    rows, columns = height_m.shape
    for row in range(rows):
        line = values[MARGIN + row]
        for i in range(columns):
            line[MARGIN + i] = height_m[row, i]
    for i in range(1, MARGIN + 1):
        _reflect(values[MARGIN], values[MARGIN + i], values[MARGIN - i])
        last = MARGIN + rows - 1
        _reflect(values[last], values[last - i], values[last + i])
    for row in range(rows + 2 * MARGIN):
        line = values[row]
        last = MARGIN + columns - 1
        for i in range(1, MARGIN + 1):
            line[MARGIN - i] = 2 * line[MARGIN] - line[MARGIN + i]
            line[last + i] = 2 * line[last] - line[last - i]
    for row in range(rows + 2 * MARGIN):
        inside = min(max(row - MARGIN, 0), rows - 1)
        _level(values[row], near[RING + inside], height_m[inside], inside + MARGIN == row)


@inner()
def _reflect(edge, within, beyond):
    for i in range(edge.shape[0]):
        beyond[i] = 2 * edge[i] - within[i]


@inner()
def _level(line, near, heights, inside):
    """Extend the height of a cell at a jump beyond the border. inside: True for a row with heights of its own."""
    columns = heights.shape[0]
    for i in range(MARGIN):
        if near[RING]:
            line[i] = heights[0]
        if near[RING + columns - 1]:
            line[MARGIN + columns + i] = heights[columns - 1]
    if not inside:
        for i in range(columns):
            if near[RING + i]:
                line[MARGIN + i] = heights[i]


@inner()
def _ease_value(a, b, c, d, e, before, here, after):
    """Return the middle of five values, moved against overshoot of the spline if `here` is 1."""
    left, middle, right = b + before * _peak(a, b, c), c + here * _peak(b, c, d), d + after * _peak(c, d, e)
    value = middle + ((right - middle) - (middle - left)) * SIXTH
    return value if here > NOTHING else c


@inner()
def _peak(a, b, c):
    """Return half the height of a single peak above its neighbours, or of a pit below (negative); otherwise 0."""
    up, down = b - a, b - c
    less = up if abs(up) < abs(down) else down
    return HALF * less if up * down > NOTHING else NOTHING


@inner()
def _ease_down(values, result, row, before, here, after):
    """Ease a row down the columns; before, here, after: masks of cells near a jump, of the row and its neighbours."""
    for i in range(here.shape[0]):
        j = i + MARGIN - RING
        result[j] = _ease_value(
            values[row - 2, j],
            values[row - 1, j],
            values[row, j],
            values[row + 1, j],
            values[row + 2, j],
            float32(before[i]),
            float32(here[i]),
            float32(after[i]),
        )


@inner()
def _ease_along(values, result, near):
    for i in range(values.shape[0]):
        result[i] = values[i]
    for i in range(1, near.shape[0] - 1):
        j = i + MARGIN - RING
        result[j] = _ease_value(
            values[j - 2],
            values[j - 1],
            values[j],
            values[j + 1],
            values[j + 2],
            float32(near[i - 1]),
            float32(near[i]),
            float32(near[i + 1]),
        )


@inner()
def _filter_down(values, taps, row, out):
    """Filter a row of the values down the columns; its middle is TAPS rows further down."""
    middle = row + TAPS
    for i in range(out.shape[0]):
        out[i] = taps[0] * values[middle, i]
    for tap in range(1, TAPS + 1):
        weight, above, below = taps[tap], values[middle - tap], values[middle + tap]
        for i in range(out.shape[0]):
            out[i] += weight * (above[i] + below[i])


@inner()
def _filter_along(values, taps, out):
    for i in range(out.shape[0]):
        out[i] = taps[0] * values[i + TAPS]
    for tap in range(1, TAPS + 1):
        weight = taps[tap]
        for i in range(out.shape[0]):
            out[i] += weight * (values[i + TAPS - tap] + values[i + TAPS + tap])


@njit(void(HEIGHTS, float32, MASK, MASK, MASK), **KERNEL)
def mark_jumps(height_m, rounding, at, wide, near):
    """Mark the cells at jumps as `surface.jumps` does, and in `near` also their neighbours up to two cells away."""
    # near is extended by BORDER copies of the outermost cells on each side, and a ring of 0 around these.
    rows, columns = height_m.shape
    for row in range(rows):
        for column in range(columns):
            at[row, column] = 0
    _down(height_m, at, rounding)
    _along(height_m, at, rounding)
    _widen(at, wide, near)


@njit(void(HEIGHTS, MASK, LINE, ROWS, ROWS, ROWS), **KERNEL)
def filter_coefficients(height_m, near, taps, values, smooth, coefficients):
    """Compute `spline_coefficients`: extend, then ease and filter down the columns, then along the rows."""
    rows, columns = height_m.shape
    _continue(height_m, near, values)
    for row in range(rows + 2 * MARGIN):
        for i in range(columns + 2 * MARGIN):
            smooth[row, i] = values[row, i]
        i = row - MARGIN + RING
        if 0 < i < near.shape[0] - 1:
            _ease_down(values, smooth[row], row, near[i - 1], near[i], near[i + 1])
    for row in range(rows + 2 * BORDER):
        _filter_down(smooth, taps, row, values[row])
        _ease_along(values[row], smooth[row], near[row + 1])  # no later row reads this one
        _filter_along(smooth[row], taps, coefficients[row])


@njit(types.boolean(ROWS, PAIRS, PAIRS, float32), **KERNEL)
def fill_slot(coefficients, before, free, most_m):
    """Write the way from the played slot's end to these coefficients, by at most most_m; True if it falls short."""
    # The coefficients become the end of the way.
    short = False
    rows, columns = coefficients.shape
    for row in range(rows):
        for i in range(columns):
            begin, target = before[row, i, 1], coefficients[row, i]
            way = target - begin
            end = target if abs(way) <= most_m else (begin + most_m if way > NOTHING else begin - most_m)
            free[row, i, 0], free[row, i, 1], coefficients[row, i] = begin, end, end
            short |= end != target
    return short
