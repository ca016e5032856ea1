"""Braille as a band of flat rectangles, some with a dot."""

from functools import cache

import numpy as np
from jaxtyping import Float64

from ..braille import DOT_DIAMETER_M, DOT_HEIGHT_M
from .patches import Patch, flat, join_patches, rectangle, strip

SIDES, RINGS = 12, 3
"""Sides and rings of a dot, which is within 0.03 mm of a spherical cap. The sides are a multiple of four."""


def braille_band(
    size_m: tuple[float, float], centres_m: Float64[np.ndarray, "n 2"]
) -> tuple[Patch, Float64[np.ndarray, "k 3"]]:
    """Return a flat band from the lower left corner on, with a dot at each centre; and the points along its back edge.

    The band is divided midway between dots, along whole rows and columns, so that rectangles meet at their corners.
    """
    steps_x, steps_y = (_borders(centres_m[:, axis], size_m[axis]) for axis in (0, 1))
    raised = {
        (int(np.searchsorted(steps_x, x)), int(np.searchsorted(steps_y, y))): (float(x), float(y)) for x, y in centres_m
    }
    patches = list[Patch]()
    for i in range(1, len(steps_x)):
        for j in range(1, len(steps_y)):
            box = float(steps_x[i - 1]), float(steps_y[j - 1]), float(steps_x[i]), float(steps_y[j])
            patches.append(_dot(box, raised[i, j]) if (i, j) in raised else rectangle(*box))
    return join_patches(patches), flat([(float(x), size_m[1]) for x in steps_x])


def _borders(places_m: Float64[np.ndarray, " n"], end_m: float) -> Float64[np.ndarray, " k"]:
    """Return 0, the middles between neighbouring places, and the end."""
    each = np.unique(places_m.round(9))
    return np.concatenate([[0.0], (each[1:] + each[:-1]) / 2, [end_m]])


def _dot(box: tuple[float, float, float, float], centre_m: tuple[float, float]) -> Patch:
    """Return a dot and the flat ground around it."""
    left_m, front_m, right_m, back_m = box
    cap = Patch(_cap().points_m + np.array([*centre_m, 0.0]), _cap().triangles)
    foot = np.concatenate([cap.points_m[:SIDES], cap.points_m[:1]])
    corners = flat([(left_m, front_m), (right_m, front_m), (right_m, back_m), (left_m, back_m), (left_m, front_m)])
    quarter = SIDES // 4
    ground = (strip(foot[n * quarter : (n + 1) * quarter + 1], corners[n : n + 2]) for n in range(4))
    return join_patches([cap, *ground])


@cache
def _cap() -> Patch:
    """Return a spherical cap about the origin: rings from the ground up, each from the lower left on, and the top."""
    radius_m = DOT_DIAMETER_M / 2
    ball_m = (radius_m**2 + DOT_HEIGHT_M**2) / (2 * DOT_HEIGHT_M)
    tilt = np.arcsin(radius_m / ball_m) * (1 - np.arange(RINGS) / RINGS)
    turn = np.radians(225) + 2 * np.pi * np.arange(SIDES) / SIDES
    across = ball_m * np.sin(tilt)[:, None]
    rise = ball_m * (np.cos(tilt) - np.cos(tilt[0]))
    rings = np.stack([across * np.cos(turn), across * np.sin(turn), np.repeat(rise[:, None], SIDES, axis=1)], axis=2)
    points = np.concatenate([rings.reshape(-1, 3), [[0.0, 0.0, DOT_HEIGHT_M]]])
    side, after = np.arange(SIDES), np.roll(np.arange(SIDES), -1)
    triangles = [
        np.stack([(RINGS - 1) * SIDES + side, (RINGS - 1) * SIDES + after, np.full(SIDES, len(points) - 1)], 1)
    ]
    for ring in range(RINGS - 1):
        low, high = ring * SIDES, (ring + 1) * SIDES
        triangles.append(np.stack([low + side, low + after, high + after], axis=1))
        triangles.append(np.stack([low + side, high + after, high + side], axis=1))
    return Patch(points, np.concatenate(triangles))
