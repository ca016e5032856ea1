"""Stereo pairs whose disparity and occlusion are known exactly: planes, steps, spheres and thin bars."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
from jaxtyping import Bool, Float32, Float64

from ...data import Record, Views

SHORTEST_PX, LONGEST_PX, WAVES = 3.0, 48.0, 24
GREY, CONTRAST = 127.5, 36.0
ROUNDING_PX = 1e-9  # difference of disparities below which a point is on the same surface

Points = Float64[np.ndarray, "..."]
Region = Callable[[Points, Points], Bool[np.ndarray, "..."]]
"""(x, y) -> whether a surface is there, in pixels of the left view."""
OfPoints = Callable[[Points, Points], Points]


@dataclass(frozen=True)
class Surface:
    """A surface that both cameras see."""

    seed: int
    region: Region
    disparity_px: OfPoints  # (x, y) -> d, larger is nearer
    seen_at: OfPoints  # (x_r, y) -> the x with x - d(x, y) = x_r


def slanted_plane(seed: int, region: Region, base_px: float, across: float = 0.0, down: float = 0.0) -> Surface:
    """Return a plane, d = base + across * x + down * y; across < 1, or the right camera would see its back."""
    return Surface(
        seed,
        region,
        lambda x, y: base_px + across * x + down * y,
        lambda right, y: (right + base_px + down * y) / (1 - across),
    )


def cap(seed: int, centre: tuple[float, float], radius_px: float, base_px: float, flatness: float = 0.7) -> Surface:
    """Return a round cap whose rim has disparity `base_px`: an ellipsoid of radius R, s R deep, within r <= R / 2."""
    # d = base + s (sqrt(R^2 - r^2) - sqrt(R^2 - radius^2)), with R = 2 radius and s = flatness <= 1, so that its slope
    # is below 0.58 and the right camera sees all of it. With u = x - x_c, v = y - y_c and k = x_r - x_c + base - s
    # sqrt(..), u - k = s sqrt(R^2 - u^2 - v^2) has the root below.
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
    """Render the view of the left camera."""
    # Analytic surfaces stand in front of two cameras; no picture is ever warped. A surface is a disparity d(x, y) over
    # the left view, and a texture painted on it. The right view at (x_r, y) shows the nearest surface among the points
    # x that solve x - d(x, y) = x_r, which each surface knows in closed form. A pixel mixes points x points within it:
    # the textures are band-limited, so only edges need it.
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
        inside = share > 0
        x, y = columns[inside], rows[inside]
        grey[inside] += share[inside] * texture(surface.seed, where(surface, x, y), y)
    return grey


def _shares(
    surfaces: Sequence[Surface], x: Points, y: Points, points: int, where: Where
) -> Float64[np.ndarray, "n h w"]:
    shares = np.zeros((len(surfaces), *x.shape))
    offsets = (np.arange(points) + 0.5) / points - 0.5
    for down, across in product(offsets, offsets):
        nearest = np.argmax(
            [_depth(surface, where(surface, x + across, y + down), y + down) for surface in surfaces], axis=0
        )
        for index in range(len(surfaces)):
            shares[index] += nearest == index
    return shares / points**2


def _depth(surface: Surface, x: Points, y: Points) -> Points:
    """Return the disparity in the surface's region, minus infinity elsewhere."""
    return np.where(surface.region(x, y), surface.disparity_px(x, y), -np.inf)


FAR, NEAR = 0.02, 0.1
BAR_WIDTHS_PX = (1.5, 2.0, 3.0, 5.0, 8.0)
BACKGROUND, FIRST = 1, 2


@dataclass(frozen=True, eq=False)
class KnownPair(Record):
    """A pair and its truth: disparity in px of every left pixel, and whether the right view shows it too."""

    views: Views
    truth_px: Float32[np.ndarray, "h w"]
    visible: Bool[np.ndarray, "h w"]


def synthetic_pair(name: str, width_px: int = 480, height_px: int = 360, seed: int = 0) -> KnownPair:
    """Return one of SCENES in uint8 grey; layout and textures follow from the seed. Raises: KeyError."""
    shape = (height_px, width_px)
    surfaces = SCENES[name](width_px, height_px, np.random.default_rng(seed), 1000 * seed)
    left, right = (np.rint(np.clip(view(surfaces, shape), 0, 255)).astype(np.uint8) for view in (left_view, right_view))
    return KnownPair(
        Views(left, right), true_disparity(surfaces, shape).astype(np.float32), truly_visible(surfaces, shape)
    )


def planes(width: int, height: int, random: np.random.Generator, seed: int) -> list[Surface]:
    """Return five slanted rectangles in front of slanted ground."""
    surfaces = [slanted_plane(seed + BACKGROUND, everywhere, FAR * width, 0.01, 0.025 * width / height)]
    for index in range(5):
        left, top = random.uniform(0.02, 0.7) * width, random.uniform(0.02, 0.65) * height
        region = rectangle(left, top, left + random.uniform(0.15, 0.3) * width, top + random.uniform(0.2, 0.4) * height)
        across, down = random.uniform(-0.06, 0.06, 2)
        base = random.uniform(0.06, NEAR) * width - across * left - down * top
        surfaces.append(slanted_plane(seed + FIRST + index, region, base, across, down))
    return surfaces


def steps(width: int, height: int, random: np.random.Generator, seed: int) -> list[Surface]:
    """Return a staircase: upright strips that face the cameras, each nearer or farther than its neighbour."""
    edges = np.linspace(0, width, 8)
    shares = np.linspace(FAR, NEAR, edges.size - 1)
    random.shuffle(shares)
    return [slanted_plane(seed + BACKGROUND, everywhere, FAR * width / 2)] + [
        slanted_plane(seed + FIRST + index, rectangle(left, 0.1 * height, right, 0.9 * height), share * width)
        for index, (left, right, share) in enumerate(zip(edges[:-1], edges[1:], shares, strict=True))
    ]


def spheres(width: int, height: int, random: np.random.Generator, seed: int) -> list[Surface]:
    """Return six round caps in front of a wall."""
    surfaces = [slanted_plane(seed + BACKGROUND, everywhere, FAR * width)]
    for index in range(6):
        centre = ((index % 3 + random.uniform(0.3, 0.7)) * width / 3, (index // 3 + 0.5) * height / 2)
        radius = random.uniform(0.12, 0.2) * min(width, height)
        surfaces.append(cap(seed + FIRST + index, centre, radius, random.uniform(1.5, 3) * FAR * width))
    return surfaces


def bars(width: int, height: int, random: np.random.Generator, seed: int) -> list[Surface]:
    """Return thin bars in front of a wall: most methods lose them, or make them thicker."""
    surfaces = [slanted_plane(seed + BACKGROUND, everywhere, FAR * width)]
    for index, (place, thickness) in enumerate(
        zip(np.linspace(0.16, 0.92, len(BAR_WIDTHS_PX)), random.permutation(BAR_WIDTHS_PX), strict=True)
    ):
        left = place * width + random.uniform(0, 1)
        region = rectangle(left, 0.1 * height, left + thickness, 0.9 * height)
        surfaces.append(slanted_plane(seed + FIRST + index, region, random.uniform(0.05, NEAR) * width))
    return surfaces


SCENES: Mapping[str, Callable[[int, int, np.random.Generator, int], list[Surface]]] = {
    "planes": planes,
    "steps": steps,
    "spheres": spheres,
    "bars": bars,
}
