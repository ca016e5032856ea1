"""The point of an analytic surface that is nearest to a hand inside it, for the surfaces of `scenes` and `reliefs`.

All are closed forms except the waves. Each function takes hands inside and above its surface; the results of the ones
above are meaningless. Where two faces meet in an edge, a point stays on the face through which the hand came in until
its foot leaves that face, as a proxy does: the nearest point of both would leap through the body to the other side.
"""

import numpy as np
from jaxtyping import Bool, Float64

Points = Float64[np.ndarray, "n 3"]
Flags = Bool[np.ndarray, "n"]
NEWTON_STEPS, CONVERGED_M = 60, 1e-12


def on_plane(hands_m: Points, slope: tuple[float, float], height_m: float) -> Points:
    """Return the foot of the perpendicular on z = height + slope . (x, y)."""
    upright = np.array((-slope[0], -slope[1], 1.0))
    over = hands_m @ upright - height_m
    return hands_m - over[:, None] * (upright / (upright @ upright))


def on_sphere(hands_m: Points, radius_m: float, base_m: float) -> Points:
    """Return the point on the ray through the hand from the centre, which is `base_m` under the base plane."""
    centre = np.array((0.0, 0.0, -base_m))
    out = hands_m - centre
    return centre + radius_m * out / np.linalg.norm(out, axis=1, keepdims=True)


def on_cone(hands_m: Points, slope: float, top_m: float) -> Points:
    """Return the foot on the cone's line above the hand; for a hand on the axis, on the line along x."""
    radius = np.hypot(hands_m[:, 0], hands_m[:, 1])
    foot = on_plane(np.column_stack([radius, np.zeros(radius.size), hands_m[:, 2]]), (-slope, 0.0), top_m)
    angle = np.arctan2(hands_m[:, 1], hands_m[:, 0])
    return np.column_stack([foot[:, 0] * np.cos(angle), foot[:, 0] * np.sin(angle), foot[:, 2]])


def on_ridge(hands_m: Points, slope: float, top_m: float) -> Points:
    """Return the foot on one of the two planes, z = top - slope |x|."""
    left, right = (on_plane(hands_m, (rise, 0.0), top_m) for rise in (slope, -slope))
    inside = hands_m[:, 2] < top_m - slope * np.abs(hands_m[:, 0])
    on_right = _face(inside, hands_m[:, 0] > 0, left[:, 0] > 0, right[:, 0] < 0)
    return np.where(on_right[:, None], right, left)


def on_step(hands_m: Points, high_m: float) -> Points:
    """Return the point on the top (z = high, x >= 0), or on the ground (z = 0, x <= 0) and the wall.

    The face is that through which the hand came in.
    """
    x, y, z = hands_m[:, 0], hands_m[:, 1], hands_m[:, 2]
    low = np.column_stack([np.minimum(x, 0), y, np.maximum(z, 0)])
    top = np.column_stack([np.maximum(x, 0), y, np.full(x.size, high_m)])
    inside = z < np.where(x > 0, high_m, 0.0)
    on_top = _face(inside, x > 0, np.zeros(x.size, np.bool_), x < 0)
    return np.where(on_top[:, None], top, low)


def on_waves(hands_m: Points, amplitude_m: float, wavelength_m: float) -> Points:
    """Find the point by Newton's method on h = A + A sin(2 pi x / L) sin(2 pi y / L), from straight above the hand.

    NaN for a hand at least 1 / (A k^2) from it, k = 2 pi / L, the crests' radius of curvature: so deep there may be
    several nearest points.
    """
    places, step = hands_m[:, :2], np.full((len(hands_m), 2), np.inf)
    for _ in range(NEWTON_STEPS):
        height, slope, bend = _waves(places, amplitude_m, wavelength_m)
        away = np.minimum(hands_m[:, 2] - height, 0)
        matrix = np.eye(2) + slope[:, :, None] * slope[:, None] - away[:, None, None] * bend
        downhill = hands_m[:, :2] - places + away[:, None] * slope
        step = np.linalg.solve(matrix, downhill[:, :, None])[:, :, 0]
        places = places + step
        if np.abs(step).max(initial=0.0) < CONVERGED_M:
            break
    points = np.column_stack([places, _waves(places, amplitude_m, wavelength_m)[0]])
    curve_m = (wavelength_m / (2 * np.pi)) ** 2 / amplitude_m
    only = (np.abs(step).max(axis=1) < CONVERGED_M) & (np.linalg.norm(points - hands_m, axis=1) < curve_m)
    return np.where(only[:, None], points, np.nan)


def _waves(
    places_m: Float64[np.ndarray, "n 2"], amplitude_m: float, wavelength_m: float
) -> tuple[Float64[np.ndarray, "n"], Float64[np.ndarray, "n 2"], Float64[np.ndarray, "n 2 2"]]:
    """Return height, gradient and Hessian."""
    k = 2 * np.pi / wavelength_m
    (sx, sy), (cx, cy) = np.sin(k * places_m.T), np.cos(k * places_m.T)
    bend = amplitude_m * k**2 * np.array([[-sx * sy, cx * cy], [cx * cy, -sx * sy]])
    return amplitude_m * (1 + sx * sy), amplitude_m * k * np.column_stack([cx * sy, sx * cy]), np.moveaxis(bend, 2, 0)


def _face(inside: Flags, starts: Flags, leaves_first: Flags, leaves_second: Flags) -> Flags:
    """Test whether each point is on the second face: the face over which the hand came in, until it leaves that."""
    second = bool(starts[:1].any())
    on_second = np.empty_like(inside)
    for tick, (within, start, first_ends, second_ends) in enumerate(
        zip(inside.tolist(), starts.tolist(), leaves_first.tolist(), leaves_second.tolist(), strict=True)
    ):
        second = start if not within else not second_ends if second else first_ends
        on_second[tick] = second
    return on_second
