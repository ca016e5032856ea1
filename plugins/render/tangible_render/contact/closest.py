"""Where the proxy comes to rest on a C2 surface: the nearest point, or where friction holds it; compiled.

Minimises |p - q|^2 / 2 over the surface's points p = (x, y, h(x, y)) for a hand q, by Newton's method with guards:
without them it divides by zero or flies off on noise and cliffs. Imports numba: a method imports this module inside
its verb.
"""

# ruff: noqa: ANN001, ANN201, ANN202 -- the types are in the signatures that numba compiles

import math

from tangible_core.compiled.compiling import inner

from ..surface.spline import bend

STEPS = 8
"""Newton steps a tick; on a smooth surface at the speed of a hand, one or two are taken."""
STEP_M = 2.5e-4
"""No step is longer."""
BACK_OFFS, BACK_OFF = 3, 0.35
"""A step that brings the proxy no nearer is shortened so often at most, and by this factor."""
NEAR_CELLS, NEAR_M, NEAR_FINE_CELLS = 1 / 128, 2e-6, 1 / 8
"""A Newton step shorter than 1/128 of a cell is the last, and the spline is not read again: its Taylor series is
followed. On cells finer than 256 um a step of up to 2 um is, but of no more than 1/8 of a cell: a step that is long for
them is still short for what they show."""
STEEP = 0.1
"""Newton's matrix is used where its determinant is over this part of the one without curvature (Gauss-Newton)."""


@inner(forceinline=True)
def settle(
    coefficients,
    width_m,
    length_m,
    across_per_m,
    down_per_m,
    px,
    py,
    x,
    y,
    z,
    static_friction,
    dynamic_friction,
    slides,
):
    """Proxy (x, y, height, slope_x, slope_y, slides) for a hand at (x, y, z), starting from the last proxy (px, py).

    With friction the proxy stays where it is while the force is within the static cone (the dynamic one if it slides
    already), and otherwise goes on until the force is on the dynamic cone.
    """
    half, cell_m = (0.5 * width_m, 0.5 * length_m), 1.0 / max(across_per_m, down_per_m)
    near_m = max(NEAR_CELLS * cell_m, min(NEAR_M, NEAR_FINE_CELLS * cell_m))
    expansion = bend(coefficients, across_per_m, down_per_m, px, py)
    if static_friction > 0.0:
        along, normal = _parts(expansion, x - px, y - py, z - expansion[0])
        if along <= (dynamic_friction if slides > 0.0 else static_friction) * normal:
            return px, py, expansion[0], expansion[1], expansion[2], 0.0
        slides = 1.0
    for _ in range(STEPS):
        away = x - px, y - py, z - expansion[0]
        share = 1.0
        if static_friction > 0.0:
            along, normal = _parts(expansion, *away)
            share = 1.0 - dynamic_friction * normal / along
            if not share > 0.0:
                break
        sx, sy, newton = _step(half, px, py, away, expansion, share)
        if newton and sx * sx + sy * sy <= near_m * near_m:
            h, hx, hy = _taylor(expansion, sx, sy)
            return px + sx, py + sy, h, hx, hy, slides
        sx, sy, there, nearer = _accept(coefficients, across_per_m, down_per_m, px, py, sx, sy, x, y, z, away)
        if not nearer:
            break
        px, py, expansion = px + sx, py + sy, there
    return px, py, expansion[0], expansion[1], expansion[2], slides


@inner()
def _parts(expansion, dx, dy, dz):
    """Lengths of the way from proxy to hand along the surface and along its normal."""
    _, hx, hy, _, _, _ = expansion
    inward = hx * dx + hy * dy - dz
    square = inward * inward / (1.0 + hx * hx + hy * hy)
    return math.sqrt(max(dx * dx + dy * dy + dz * dz - square, 0.0)), math.sqrt(square)


@inner()
def _step(half, px, py, away, expansion, share):
    """This share of Newton's step, or of Gauss and Newton's, within the borders; (step_x, step_y, whether Newton's)."""
    (dx, dy, dz), (_, hx, hy, hxx, hxy, hyy) = away, expansion
    gx, gy = share * (dx + hx * dz), share * (dy + hy * dz)
    xx, xy, yy = 1.0 + hx * hx, hx * hy, 1.0 + hy * hy
    plain = xx + hy * hy
    nxx, nxy, nyy = xx - hxx * dz, xy - hxy * dz, yy - hyy * dz
    determinant = nxx * nyy - nxy * nxy
    newton = nxx > 0.0 and determinant > STEEP * plain
    if newton:
        xx, xy, yy = nxx, nxy, nyy
    else:
        determinant = plain
    inverse = 1.0 / determinant
    sx, sy = (yy * gx - xy * gy) * inverse, (xx * gy - xy * gx) * inverse
    if abs(px + sx) > half[0]:
        sx = math.copysign(half[0], px + sx) - px
        sy = (gy - xy * sx) / yy
    if abs(py + sy) > half[1]:
        sy = math.copysign(half[1], py + sy) - py
        sx = min(max((gx - xy * sy) / xx, -half[0] - px), half[0] - px)
    if sx * sx + sy * sy > STEP_M * STEP_M:
        shorter = STEP_M / math.sqrt(sx * sx + sy * sy)
        sx, sy = shorter * sx, shorter * sy
    return sx, sy, newton


@inner()
def _accept(coefficients, across_per_m, down_per_m, px, py, sx, sy, x, y, z, away):
    """The step, shortened until it brings the proxy nearer to the hand; what the surface is there; whether it does."""
    before = _square(*away)
    there = bend(coefficients, across_per_m, down_per_m, px + sx, py + sy)
    for _ in range(BACK_OFFS):
        if _square(x - px - sx, y - py - sy, z - there[0]) < before:
            return sx, sy, there, True
        sx, sy = BACK_OFF * sx, BACK_OFF * sy
        there = bend(coefficients, across_per_m, down_per_m, px + sx, py + sy)
    return sx, sy, there, _square(x - px - sx, y - py - sy, z - there[0]) < before


@inner()
def _square(dx, dy, dz):
    return dx * dx + dy * dy + dz * dz


@inner()
def _taylor(expansion, sx, sy):
    """Height and slopes a small step away."""
    h, hx, hy, hxx, hxy, hyy = expansion
    rise = hx * sx + hy * sy + 0.5 * (hxx * sx * sx + hyy * sy * sy) + hxy * sx * sy
    return h + rise, hx + hxx * sx + hxy * sy, hy + hxy * sx + hyy * sy
