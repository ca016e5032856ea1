"""Paths of a hand over a surface, with the exact nearest points of analytic surfaces to hands inside and above."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float64

from tangible_core.data import HapticSurface, Record, Relief
from tangible_core.scene import smooth, workspace_to_picture
from tangible_core.testing.synthetic import KnownSurface, cliff, cone, plane, ramp, ridge, sphere_cap, waves

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
    """Return the point on the top (z = high, x >= 0), or on the ground (z = 0, x <= 0) and the wall."""
    x, y, z = hands_m[:, 0], hands_m[:, 1], hands_m[:, 2]
    low = np.column_stack([np.minimum(x, 0), y, np.maximum(z, 0)])
    top = np.column_stack([np.maximum(x, 0), y, np.full(x.size, high_m)])
    inside = z < np.where(x > 0, high_m, 0.0)
    on_top = _face(inside, x > 0, np.zeros(x.size, np.bool_), x < 0)
    return np.where(on_top[:, None], top, low)


def on_waves(hands_m: Points, amplitude_m: float, wavelength_m: float) -> Points:
    """Find the point by Newton's method on h = A + A sin(2 pi x / L) sin(2 pi y / L); NaN where it is not unique."""
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
    # Deeper than the crests' radius of curvature, 1 / (A k^2) with k = 2 pi / L, there may be several nearest points.
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
    # The nearest point of both faces would leap through the body to the other side; a proxy does not.
    second = bool(starts[:1].any())
    on_second = np.empty_like(inside)
    for tick, (within, start, first_ends, second_ends) in enumerate(
        zip(inside.tolist(), starts.tolist(), leaves_first.tolist(), leaves_second.tolist(), strict=True)
    ):
        second = start if not within else not second_ends if second else first_ends
        on_second[tick] = second
    return on_second


Heights = Callable[[Float64[np.ndarray, "n"], Float64[np.ndarray, "n"]], Float64[np.ndarray, "n"]]
"""(x, y) -> z, metres."""
PERIOD_S = 0.001
LOOPS, LOOP_TICKS = 4, 2000
LIFTED = 0.2  # share of a loop that each lift takes, up or down
CLEAR_M = 0.001  # height of the lifted hand over the highest point
# Largest distance of the hand from the centre, as a share of the surface's width and length.
REACH = 0.375
# Sigma of the Gaussian that removes details finer than a fingertip from the path over a relief.
FINGER_M = 0.001


@dataclass(frozen=True, eq=False)
class KnownStroke(Record):
    """A path of a hand over a surface, and the true position of a proxy without friction at each tick."""

    surface: HapticSurface
    position_m: Float64[np.ndarray, "n 3"]
    nearest_m: Float64[np.ndarray, "n 3"]
    """Nearest point of the surface; in free air the hand itself, so that a spring has no force; NaN if unknown."""
    period_s: float = PERIOD_S


@dataclass(frozen=True)
class Analytic:
    """A surface given by a formula, its nearest point to any hand inside it, and the range of the hand's path."""

    # (rows, columns) -> the surface of these cells, 80 mm wide.
    surface: Callable[[tuple[int, int]], KnownSurface]
    nearest: Callable[[Points], Points]
    across_m: tuple[float, float] = (-0.03, 0.03)  # range of x of the hand
    ride_m: Callable[[float, float], float] | None = None  # height that the hand follows, if not the surface's


SURFACES: Mapping[str, Analytic] = {
    "plane": Analytic(lambda shape: plane(0.01, shape), lambda hands: on_plane(hands, (0.0, 0.0), 0.01)),
    "ramp": Analytic(lambda shape: ramp((0.2, 0.1), 0.015, shape), lambda hands: on_plane(hands, (0.2, 0.1), 0.015)),
    "sphere": Analytic(lambda shape: sphere_cap(0.1, 0.08, shape), lambda hands: on_sphere(hands, 0.1, 0.08)),
    "sine": Analytic(lambda shape: waves(0.004, 0.02, shape), lambda hands: on_waves(hands, 0.004, 0.02)),
    "cone": Analytic(lambda shape: cone(0.5, 0.04, shape), lambda hands: on_cone(hands, 0.5, 0.04)),
    "ridge": Analytic(lambda shape: ridge(0.5, 0.03, shape), lambda hands: on_ridge(hands, 0.5, 0.03)),
    # along the ground, against the wall and back, and once down over its edge: no hand goes through a wall
    "step": Analytic(
        lambda shape: cliff(0.004, shape), lambda hands: on_step(hands, 0.004), (-0.03, 0.0015), lambda x, y: 0.0
    ),
}


def analytic_stroke(
    name: str, cells: int = 256, depth_m: float = 0.001, path_m: Points | None = None, period_s: float = PERIOD_S
) -> KnownStroke:
    """Return a path over one of SURFACES of cells x cells: `path_m`, or the scripted one. Raises: KeyError."""
    analytic = SURFACES[name]
    exact = analytic.surface((cells, cells))
    if path_m is None:
        ride = _vectorise(analytic.ride_m or exact.height_m)
        path_m = scripted_path(exact.surface.relief, ride, depth_m, analytic.across_m)
    border_m = np.divide(exact.surface.extent_m, 2)
    over = np.clip(path_m[:, :2], -border_m, border_m)
    inside = path_m[:, 2] < _vectorise(exact.height_m)(over[:, 0], over[:, 1])
    nearest_m = np.where(inside[:, None], analytic.nearest(path_m), path_m)
    nearest_m[(over != path_m[:, :2]).any(axis=1)] = np.nan
    return KnownStroke(exact.surface, path_m, nearest_m, period_s)


def relief_stroke(
    surface: HapticSurface, depth_m: float = 0.001, path_m: Points | None = None, period_s: float = PERIOD_S
) -> KnownStroke:
    """Return a path over any surface; as nothing is known between its cells, the nearest points are NaN."""
    if path_m is None:
        path_m = scripted_path(surface.relief, _smooth_heights(surface.relief), depth_m)
    return KnownStroke(surface, path_m, np.full_like(path_m, np.nan), period_s)


def scripted_path(relief: Relief, ride: Heights, depth_m: float, across_m: tuple[float, float] | None = None) -> Points:
    """Return the path of a hand over a surface, (n, 3), 1 ms apart: four loops of 2 s, from free air to free air."""
    t = np.arange(LOOPS * LOOP_TICKS + 1) / (LOOPS * LOOP_TICKS)
    width_m, length_m = relief.extent_m
    left, right = across_m or (-REACH * width_m, REACH * width_m)
    x = (left + right) / 2 + (right - left) / 2 * np.sin(2 * np.pi * 3 * t)
    y = REACH * length_m * np.sin(2 * np.pi * 2 * t + 0.7)
    phase = LOOPS * t % 1
    to_border = np.minimum(phase, 1 - phase) / LIFTED
    lift = 0.5 + 0.5 * np.cos(np.pi * np.minimum(to_border, 1))
    z = (1 - lift) * (ride(x, y) - depth_m) + lift * (float(relief.height_m.max()) + CLEAR_M)
    return np.column_stack([x, y, z])


def _vectorise(height_m: Callable[[float, float], float]) -> Heights:
    return lambda x, y: np.array([height_m(*place) for place in zip(x.tolist(), y.tolist(), strict=True)], np.float64)


def _smooth_heights(relief: Relief) -> Heights:
    """Return the heights that a finger follows, linear between the cells."""
    from scipy.ndimage import map_coordinates

    heights = smooth(relief, FINGER_M).height_m.astype(np.float64)

    def ride(x_m: Float64[np.ndarray, "n"], y_m: Float64[np.ndarray, "n"]) -> Float64[np.ndarray, "n"]:
        columns, rows = workspace_to_picture(x_m, y_m, heights.shape, relief.extent_m)
        return map_coordinates(heights, (rows, columns), order=1, mode="nearest")

    return ride
