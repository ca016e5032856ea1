"""Height, slope and curvature of a C2 surface at a point (Unser, Aldroubi & Eden 1993); import it inside a verb."""

# pyright: reportCallIssue=false

from typing import Any

from llvmlite import ir
from numba import int64, types
from numba.extending import intrinsic

from tangible_core.compiled import KERNEL, inner, inner_by_type, njit

BYTE: Any = ir.IntType(8).as_pointer()
FLAG: Any = ir.IntType(32)
# The flags of LLVM's prefetch: for reading, into all levels of the cache, data rather than instructions.
READ, KEEP, DATA = 0, 3, 1


@njit(**KERNEL)
def height(coefficients, across_per_m, down_per_m, x, y):
    """Return the height at a point over the extent. across_per_m, down_per_m: cells per metre along x and against y."""
    row, column, down, across = _place(coefficients, across_per_m, down_per_m, x, y)
    return _dot(_rows(coefficients, row, column, _values(down)), _values(across))


@njit(**KERNEL)
def slope(coefficients, across_per_m, down_per_m, x, y):
    """Return height and gradient (h, dh/dx, dh/dy) at a point over the extent."""
    row, column, down, across = _place(coefficients, across_per_m, down_per_m, x, y)
    line, value = _rows(coefficients, row, column, _values(down)), _values(across)
    rise = _dot(_rows(coefficients, row, column, _slopes(down)), value)
    return _dot(line, value), _dot(line, _slopes(across)) * across_per_m, -rise * down_per_m


@njit(**KERNEL)
def bend(coefficients, across_per_m, down_per_m, x, y):
    """Return height, gradient and Hessian (h, h_x, h_y, h_xx, h_xy, h_yy) at a point over the extent."""
    row, column, down, across = _place(coefficients, across_per_m, down_per_m, x, y)
    line = _rows(coefficients, row, column, _values(down))
    rise = _rows(coefficients, row, column, _slopes(down))
    curve = _rows(coefficients, row, column, _bends(down))
    value, tilt = _values(across), _slopes(across)
    return (
        _dot(line, value),
        _dot(line, tilt) * across_per_m,
        -_dot(rise, value) * down_per_m,
        _dot(line, _bends(across)) * across_per_m * across_per_m,
        -_dot(rise, tilt) * across_per_m * down_per_m,
        _dot(curve, value) * down_per_m * down_per_m,
    )


@inner()
def prefetch(coefficients, across_per_m, down_per_m, x, y):
    """Prefetch the coefficients of a point, without waiting for them."""
    row, column, _, _ = _place(coefficients, across_per_m, down_per_m, x, y)
    for line in range(row, row + 4):
        _fetch(coefficients, line, column)
        _fetch(coefficients, line, column + 3)


@inner()
def _place(coefficients, across_per_m, down_per_m, x, y):
    """Return the first row and column of a point's 4 x 4 coefficients, and its offset beyond the second ones."""
    rows, columns = _shape(coefficients)
    down, across = 0.5 * (rows - 1) - y * down_per_m, 0.5 * (columns - 1) + x * across_per_m
    row, column = min(max(int(down), 1), rows - 3), min(max(int(across), 1), columns - 3)
    return row - 1, column - 1, down - row, across - column


@inner()
def _values(t):
    """Return the four B-splines over an interval, at t in 0..1 of it."""
    u = 1.0 - t
    first, last = u * u * u / 6.0, t * t * t / 6.0
    second = 2.0 / 3.0 - t * t * (1.0 - 0.5 * t)
    return first, second, 1.0 - first - second - last, last


@inner()
def _slopes(t):
    u = 1.0 - t
    return -0.5 * u * u, t * (1.5 * t - 2.0), u * (2.0 - 1.5 * u), 0.5 * t * t


@inner()
def _bends(t):
    return 1.0 - t, 3.0 * t - 2.0, 1.0 - 3.0 * t, t


@inner()
def _rows(coefficients, row, column, weights):
    return (
        _column(coefficients, row, column, weights),
        _column(coefficients, row, column + 1, weights),
        _column(coefficients, row, column + 2, weights),
        _column(coefficients, row, column + 3, weights),
    )


@inner()
def _dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3]


@intrinsic
def _prefetch_line(context: Any, array: Any, offset: Any) -> Any:
    """Prefetch the cache line at a byte offset into an array; it neither waits nor fails."""

    def generate(context, builder, signature, arguments):
        data = context.make_array(signature.args[0])(context, builder, arguments[0]).data
        at = builder.gep(builder.bitcast(data, BYTE), [arguments[1]])
        kind = ir.FunctionType(ir.VoidType(), [BYTE, FLAG, FLAG, FLAG])
        prefetch = builder.module.declare_intrinsic("llvm.prefetch", [BYTE], kind)
        builder.call(prefetch, [at, *(ir.Constant(FLAG, flag) for flag in (READ, KEEP, DATA))])
        return context.get_dummy_value()

    return types.void(array, int64), generate


def _shape_of_one(coefficients):
    return coefficients.shape


def _shape_of_two(coefficients):
    return coefficients[0].shape[0], coefficients[0].shape[1]


def _fetch_of_one(coefficients, row, column):
    _prefetch_line(coefficients, row * coefficients.strides[0] + column * coefficients.strides[1])


def _fetch_of_two(coefficients, row, column):
    pairs, _, _ = coefficients
    _prefetch_line(pairs, row * pairs.strides[0] + column * pairs.strides[1])


def _column_of_one(coefficients, row, column, weights):
    return (
        weights[0] * coefficients[row, column]
        + weights[1] * coefficients[row + 1, column]
        + weights[2] * coefficients[row + 2, column]
        + weights[3] * coefficients[row + 3, column]
    )


def _column_of_two(coefficients, row, column, weights):
    """Return the weighted sum of both surfaces: exactly one of them where it has all the weight."""
    pairs, first, last = coefficients
    of_first = (
        weights[0] * pairs[row, column, 0]
        + weights[1] * pairs[row + 1, column, 0]
        + weights[2] * pairs[row + 2, column, 0]
        + weights[3] * pairs[row + 3, column, 0]
    )
    of_last = (
        weights[0] * pairs[row, column, 1]
        + weights[1] * pairs[row + 1, column, 1]
        + weights[2] * pairs[row + 2, column, 1]
        + weights[3] * pairs[row + 3, column, 1]
    )
    return first * of_first + last * of_last


@inner_by_type(lambda coefficients: _shape_of_two if _moves(coefficients) else _shape_of_one)
def _shape(coefficients):
    """Return rows and columns of the coefficients."""


@inner_by_type(lambda coefficients, row, column: _fetch_of_two if _moves(coefficients) else _fetch_of_one)
def _fetch(coefficients, row, column):
    """Prefetch the cache line of a coefficient."""


@inner_by_type(lambda coefficients, row, column, weights: _column_of_two if _moves(coefficients) else _column_of_one)
def _column(coefficients, row, column, weights):
    """Return the weighted sum of four rows of a column."""


def _moves(kind):
    """Return True if numba's type of the coefficients is that of a moving surface."""
    # The coefficients of a moving surface are (pairs, first, last): two surfaces (h, w, 2), weighted by first and last.
    return isinstance(kind, types.BaseTuple)
