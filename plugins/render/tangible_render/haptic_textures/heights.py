"""The height of a texture at a point, compiled; import it inside the verb that needs it."""

import math
from typing import Any

import numpy as np
from llvmlite import ir
from numba import float64, int64, types
from numba.core import cgutils
from numba.extending import intrinsic
from numba.np.arrayobj import populate_array

from tangible_core.compiled import KERNEL, inner, njit

from .table import COUNT, HEAD, WAVES

# Turns a tick up to which a wave is whole, and from which it is gone: no servo renders over 1/3 of its rate.
WHOLE, GONE = 1 / 5, 1 / 3
TEXTURES = types.Array(float64, 2, "C", readonly=True)

SINE = tuple((-1.0) ** n * math.pi ** (2 * n + 1) / math.factorial(2 * n + 1) for n in range(8))
# Taylor coefficients: sin(pi t) = t series(SINE, t^2), cos(pi t) = series(COSINE, t^2), for |t| <= 1/2.
COSINE = tuple((-1.0) ** n * math.pi ** (2 * n) / math.factorial(2 * n) for n in range(8))


@inner(forceinline=True)
def remaining(turns):
    """Return the share of a wave's amplitude that remains at this many turns a tick."""
    # A wave of frequency f, crossed at a velocity v, is a vibration of f.v hertz. Campion & Hayward (World Haptics
    # 2005): it needs a wavelength above 2 v T to be sampled at all, and 5 to 10 samples a period to feel right.
    over = min(max((turns - WHOLE) / (GONE - WHOLE), 0.0), 1.0)
    return 1.0 - over * over * (3.0 - 2.0 * over)


@inner(forceinline=True)
def series(terms, u):
    """Evaluate a polynomial of eight terms in u, in two independent halves."""
    low = terms[0] + u * (terms[1] + u * (terms[2] + u * terms[3]))
    return low + u * u * u * u * (terms[4] + u * (terms[5] + u * (terms[6] + u * terms[7])))


# `intrinsic`, without a type: its functions are called without their first parameter, the typing context.
operation: Any = intrinsic


@operation(prefer_literal=True)
def _scratch(_context, count):
    """Allocate an array of this many float64 on the stack, which must not leave its function."""

    def emit(context, builder, signature, _arguments):
        number = ir.DoubleType()
        data = cgutils.alloca_once(builder, ir.ArrayType(number, count.literal_value))
        array = context.make_array(signature.return_type)(context, builder)
        sizes = (context.get_constant(types.intp, size) for size in (count.literal_value, 8, 8))
        shape, stride, item = sizes
        populate_array(array, builder.bitcast(data, number.as_pointer()), [shape], [stride], item, None)
        return array._getvalue()

    return types.Array(float64, 1, "C")(count), emit


@inner()
def _sum_of_waves(row, x, y, step_x, step_y):
    """Return height and gradient; unspecified where a number is not finite."""
    # First all waves, vectorised, then their sums, in order: sums that a compiler may reorder have other last bits with
    # every width of a processor's vectors.
    count = int(row[COUNT])
    heights, slopes_x, slopes_y = _scratch(WAVES), _scratch(WAVES), _scratch(WAVES)
    for i in range(count):  # from 0: a possibly negative index would be checked, which prevents vectorisation
        fx, fy = row[HEAD + i], row[HEAD + WAVES + i]
        turns = fx * x + fy * y + row[HEAD + 3 * WAVES + i]
        turns -= np.floor(turns + 0.5)
        sine, cosine = turns * series(SINE, turns * turns), series(COSINE, turns * turns)  # of half the angle
        amplitude = row[HEAD + 2 * WAVES + i] * remaining(abs(fx * step_x + fy * step_y))
        heights[i] = amplitude * (1.0 - 2.0 * sine * sine)
        slope = amplitude * sine * cosine
        slopes_x[i], slopes_y[i] = slope * fx, slope * fy
    height = slope_x = slope_y = 0.0
    for i in range(count):
        height += heights[i]
        slope_x -= slopes_x[i]
        slope_y -= slopes_y[i]
    return height, 4.0 * math.pi * slope_x, 4.0 * math.pi * slope_y


@njit(types.UniTuple(float64, 3)(TEXTURES, int64, *[float64] * 5), **KERNEL)
def texture_height(textures, material, x, y, vx, vy, dt):
    """Return (h, dh/dx, dh/dy) in metres of a row of `compile_textures`, dt the servo's period; zeros if not finite."""
    step_x, step_y = vx * dt, vy * dt
    height, slope_x, slope_y = _sum_of_waves(textures[material], x, y, step_x, step_y)
    if not np.isfinite(x + y + step_x + step_y + height + slope_x + slope_y):
        return 0.0, 0.0, 0.0
    return height, slope_x, slope_y
