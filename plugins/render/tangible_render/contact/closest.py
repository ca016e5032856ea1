"""The resting point of the proxy on a C2 surface: the nearest point, or where friction holds it; compiled."""

import math

from tangible_core.compiled import inner

from ..surface.spline import bend

# The most Newton steps in a tick; on a smooth surface at the speed of a hand, one or two are taken.
STEPS = 8
STEP_M = 2.5e-4
BACK_OFFS = 3
BACK_OFF = 0.35
# The length of the last Newton step, in cells: after a shorter one the Taylor series replaces the spline.
NEAR_CELLS = 1 / 128
# The length of the last Newton step on cells finer than 256 um, m: longer in cells, but short for their detail.
NEAR_M = 2e-6
NEAR_FINE_CELLS = 1 / 8
# The least determinant of Newton's matrix as a share of the Gauss-Newton one, which is used below it.
STEEP = 0.1


@inner(forceinline=True)
def settle(shape, px, py, x, y, z, static_friction, dynamic_friction, slides):
    """Return the proxy (x, y, height, slope_x, slope_y, slides) of a hand at (x, y, z), from the last one (px, py)."""
    coefficients, width_m, length_m, across_per_m, down_per_m = shape
    half, cell_m = (0.5 * width_m, 0.5 * length_m), 1.0 / max(across_per_m, down_per_m)
    near_m = max(NEAR_CELLS * cell_m, min(NEAR_M, NEAR_FINE_CELLS * cell_m))
    expansion = bend(coefficients, across_per_m, down_per_m, px, py)
    if static_friction > 0.0:
        along, normal = _parts(expansion, x - px, y - py, z - expansion[0])
        if along <= (dynamic_friction if slides > 0.0 else static_friction) * normal:
            return px, py, expansion[0], expansion[1], expansion[2], 0.0
        slides = 1.0
    # Minimises |p - q|^2 / 2 over the surface's points p = (x, y, h(x, y)) for a hand q, by Newton's method with
    # guards: without them it divides by zero or diverges on noise and cliffs. With friction the proxy moves until the
    # force is on the dynamic cone.
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
            h, hx, hy, hxx, hxy, hyy = expansion
            rise = hx * sx + hy * sy + 0.5 * (hxx * sx * sx + hyy * sy * sy) + hxy * sx * sy
            return px + sx, py + sy, h + rise, hx + hxx * sx + hxy * sy, hy + hxy * sx + hyy * sy, slides
        sx, sy, there, nearer = _accept(coefficients, across_per_m, down_per_m, px, py, sx, sy, x, y, z, away)
        if not nearer:
            break
        px, py, expansion = px + sx, py + sy, there
    return px, py, expansion[0], expansion[1], expansion[2], slides


@inner()
def _parts(expansion, dx, dy, dz):
    """Return the lengths of the way from proxy to hand along the surface and along its normal."""
    _, hx, hy, _, _, _ = expansion
    inward = hx * dx + hy * dy - dz
    square = inward * inward / (1.0 + hx * hx + hy * hy)
    return math.sqrt(max(dx * dx + dy * dy + dz * dz - square, 0.0)), math.sqrt(square)


@inner()
def _step(half, px, py, away, expansion, share):
    """Return this share of Newton's or the Gauss-Newton step within the borders: (step_x, step_y, is_newton)."""
    (dx, dy, dz), (_, hx, hy, hxx, hxy, hyy) = away, expansion
    gx, gy = share * (dx + hx * dz), share * (dy + hy * dz)
    xx, xy, yy = 1.0 + hx * hx, hx * hy, 1.0 + hy * hy
    plain = xx + hy * hy
    nxx, nxy, nyy = xx - hxx * dz, xy - hxy * dz, yy - hyy * dz
    determinant = nxx * nyy - nxy * nxy
    # Newton's matrix where it is safely positive; else that of Gauss and Newton, which always leads downhill.
    newton = nxx > 0.0 and determinant > STEEP * plain
    if newton:
        xx, xy, yy = nxx, nxy, nyy
    else:
        determinant = plain
    inverse = 1.0 / determinant
    sx, sy = (yy * gx - xy * gy) * inverse, (xx * gy - xy * gx) * inverse
    # At a border one coordinate is held, and the other one minimises along the border.
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
    """Shorten the step until it brings the proxy nearer; return it, the expansion there, and True if it does."""
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
