"""Analytic surfaces in front of two cameras, and the view of each camera; no picture is ever warped.

A surface is a disparity d(x, y) over the left view, and a texture painted on it: a sum of plane waves none of which is
shorter than SHORTEST_PX. The left view at (x, y) shows the nearest surface there; the right view at (x_r, y) shows the
nearest one among the points x that solve x - d(x, y) = x_r, which each surface knows in closed form.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
from jaxtyping import Bool, Float64

SHORTEST_PX, LONGEST_PX, WAVES = 3.0, 48.0, 24
GREY, CONTRAST = 127.5, 36.0
ROUNDING_PX = 1e-9
"""Difference of disparities below which a point is on the same surface."""

Points = Float64[np.ndarray, "..."]
Region = Callable[[Points, Points], Bool[np.ndarray, "..."]]
"""(x, y) -> whether a surface is there, in pixels of the left view."""
OfPoints = Callable[[Points, Points], Points]


@dataclass(frozen=True)
class Surface:
    """A surface that both cameras see."""

    seed: int
    """Seed of its texture."""
    region: Region
    disparity_px: OfPoints
    """(x, y) -> d, larger is nearer."""
    seen_at: OfPoints
    """(x_r, y) -> the x with x - d(x, y) = x_r."""


def slanted_plane(seed: int, region: Region, base_px: float, across: float = 0.0, down: float = 0.0) -> Surface:
    """Return a plane, d = base + across * x + down * y; across < 1, or the right camera would see its back."""
    return Surface(
        seed,
        region,
        lambda x, y: base_px + across * x + down * y,
        lambda right, y: (right + base_px + down * y) / (1 - across),
    )


def cap(seed: int, centre: tuple[float, float], radius_px: float, base_px: float, flatness: float = 0.7) -> Surface:
    """Return a round cap whose rim has disparity `base_px`: an ellipsoid of radius R, s R deep, within r <= R / 2.

    d = base + s (sqrt(R^2 - r^2) - sqrt(R^2 - radius^2)), with R = 2 radius and s = flatness <= 1, so that its slope is
    below 0.58 and the right camera sees all of it. With u = x - x_c, v = y - y_c and k = x_r - x_c + base - s sqrt(..),
    u - k = s sqrt(R^2 - u^2 - v^2) has the root u below.
    """
    whole = 2 * radius_px
    lowest = flatness * np.sqrt(whole**2 - radius_px**2)
    square = 1 + flatness**2

    def height(r2: Points) -> Points:
        return flatness * np.sqrt(np.maximum(whole**2 - r2, 0))

    def disparity_px(x: Points, y: Points) -> Points:
        return base_px - lowest + height((x - centre[0]) ** 2 + (y - centre[1]) ** 2)

    def seen_at(right: Points, y: Points) -> Points:
        k = right - centre[0] + base_px - lowest
        root = k**2 - square * (k**2 - flatness**2 * (whole**2 - (y - centre[1]) ** 2))
        return centre[0] + np.where(root >= 0, (k + np.sqrt(np.maximum(root, 0))) / square, np.inf)

    return Surface(seed, disc(centre, radius_px), disparity_px, seen_at)


def everywhere(x_px: Points, y_px: Points) -> Bool[np.ndarray, "..."]:
    """Return True for all points: the region of a background."""
    return np.ones(np.broadcast(x_px, y_px).shape, np.bool_)


def rectangle(left: float, top: float, right: float, bottom: float) -> Region:
    """Return the region left <= x < right and top <= y < bottom."""
    return lambda x, y: (x >= left) & (x < right) & (y >= top) & (y < bottom)


def disc(centre: tuple[float, float], radius_px: float) -> Region:
    """Return the region of points nearer to the centre than the radius."""
    return lambda x, y: (x - centre[0]) ** 2 + (y - centre[1]) ** 2 < radius_px**2


def texture(seed: int, x_px: Points, y_px: Points) -> Points:
    """Return grey levels around GREY at points of a surface: plane waves of all lengths in equal parts."""
    random = np.random.default_rng(seed)
    angles, phases = random.uniform(0, np.pi, WAVES), random.uniform(0, 2 * np.pi, WAVES)
    total = np.zeros(np.broadcast(x_px, y_px).shape)
    for length, angle, phase in zip(np.geomspace(SHORTEST_PX, LONGEST_PX, WAVES), angles, phases, strict=True):
        total += np.cos(2 * np.pi / length * (np.cos(angle) * x_px + np.sin(angle) * y_px) + phase)
    return GREY + CONTRAST * total / np.sqrt(WAVES / 2)


def left_view(surfaces: Sequence[Surface], shape: tuple[int, int], points: int = 3) -> Float64[np.ndarray, "h w"]:
    """Render the view of the left camera.

    A pixel mixes the textures at its centre, each in the share of points x points within the pixel where its surface
    is the nearest: the textures are band-limited, so only edges need it.
    """
    return _view(surfaces, shape, points, lambda surface, x, y: x)


def right_view(surfaces: Sequence[Surface], shape: tuple[int, int], points: int = 3) -> Float64[np.ndarray, "h w"]:
    """Render the view of the right camera, as `left_view`."""
    return _view(surfaces, shape, points, lambda surface, x, y: surface.seen_at(x, y))


def true_disparity(surfaces: Sequence[Surface], shape: tuple[int, int]) -> Float64[np.ndarray, "h w"]:
    """Return the disparity of the nearest surface at the centres of the left view's pixels."""
    rows, columns = np.indices(shape, np.float64)
    return np.max([_depth(surface, columns, rows) for surface in surfaces], axis=0)


def truly_visible(surfaces: Sequence[Surface], shape: tuple[int, int]) -> Bool[np.ndarray, "h w"]:
    """Test whether the right view shows the centres of the left view's pixels: inside of it and not occluded."""
    rows, columns = np.indices(shape, np.float64)
    disparity_px = true_disparity(surfaces, shape)
    right = columns - disparity_px
    nearest_px = np.max([_depth(surface, surface.seen_at(right, rows), rows) for surface in surfaces], axis=0)
    inside = (right >= -0.5) & (right < shape[1] - 0.5)
    return inside & (nearest_px <= disparity_px + ROUNDING_PX)


Where = Callable[[Surface, Points, Points], Points]
"""(surface, x, y) -> the x of the surface that a camera sees at its (x, y)."""


def _view(surfaces: Sequence[Surface], shape: tuple[int, int], points: int, where: Where) -> Float64[np.ndarray, "h w"]:
    rows, columns = np.indices(shape, np.float64)
    grey = np.zeros(shape)
    for surface, share in zip(surfaces, _shares(surfaces, columns, rows, points, where), strict=True):
        shown = share > 0
        x, y = columns[shown], rows[shown]
        grey[shown] += share[shown] * texture(surface.seed, where(surface, x, y), y)
    return grey


def _shares(
    surfaces: Sequence[Surface], x: Points, y: Points, points: int, where: Where
) -> Float64[np.ndarray, "n h w"]:
    """Return the share of each pixel that each surface fills."""
    shares = np.zeros((len(surfaces), *x.shape))
    offsets = (np.arange(points) + 0.5) / points - 0.5
    for down, across in product(offsets, offsets):
        nearest = np.argmax([_depth(each, where(each, x + across, y + down), y + down) for each in surfaces], axis=0)
        for index in range(len(surfaces)):
            shares[index] += nearest == index
    return shares / points**2


def _depth(surface: Surface, x: Points, y: Points) -> Points:
    """Return the disparity in the surface's region, minus infinity elsewhere."""
    return np.where(surface.region(x, y), surface.disparity_px(x, y), -np.inf)
