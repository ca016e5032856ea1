"""Pairs of many materials and lights with exact disparity: what a confidence is fitted to."""

from collections.abc import Callable

import numpy as np
from jaxtyping import Float64

from tangible_core.data import Views
from tangible_core.testing.synthetic.stereo_scenes import (
    KnownPair,
    Surface,
    disc,
    everywhere,
    rectangle,
    slanted_plane,
    true_disparity,
    truly_visible,
)
from tangible_core.testing.synthetic.texture_scenes import FAMILIES, smooth_noise

WIDTH, HEIGHT = 480, 360
TILE_PX = 256  # side of a material, which repeats beyond it
POINTS = 2  # points across a pixel, along either axis, of which it is the mean
NOISES, HOW_OFTEN = (0.0, 0.5, 1.0, 2.0, 4.0), (0.2, 0.3, 0.3, 0.15, 0.05)
"""Standard deviations of noise, in grey levels, and their shares."""
Where = Callable[[Surface, np.ndarray, np.ndarray], np.ndarray]


def pair_of_materials(seed: int) -> KnownPair:
    """Return a pair of 6 to 16 slanted rectangles, discs, rods and bars in front of slanted ground."""
    random = np.random.default_rng(seed)
    surfaces = _clutter(random)
    materials = [_material(random) for _ in surfaces]
    shape = HEIGHT, WIDTH
    views = [
        _view(surfaces, materials, lambda surface, x, y: x),
        _view(surfaces, materials, lambda surface, x, y: surface.seen_at(x, y)),
    ]
    left, right = _photographed(views, random)
    truth_px = true_disparity(surfaces, shape).astype(np.float32)
    return KnownPair(Views(left, right), truth_px, truly_visible(surfaces, shape))


def _clutter(random: np.random.Generator) -> list[Surface]:
    across, down = random.uniform(-0.01, 0.02), random.uniform(0, 0.04) * WIDTH / HEIGHT
    found = [slanted_plane(0, everywhere, random.uniform(0.01, 0.04) * WIDTH, across, down)]
    for _ in range(random.integers(6, 17)):
        x, y = random.uniform(-0.05, 0.95) * WIDTH, random.uniform(-0.05, 0.95) * HEIGHT
        across, down = random.uniform(-0.08, 0.08, 2)
        kind = random.integers(4)
        if kind == 0:
            region = rectangle(x, y, x + random.uniform(0.05, 0.35) * WIDTH, y + random.uniform(0.05, 0.5) * HEIGHT)
        elif kind == 1:
            region = disc((x, y), random.uniform(0.03, 0.2) * HEIGHT)
        elif kind == 2:
            region = rectangle(x, y, x + random.uniform(1.5, 12), y + random.uniform(0.2, 0.9) * HEIGHT)
            across = 0.0
        else:
            region = _rod(x, y, random.uniform(2, 14), random.uniform(-1.2, 1.2), random.uniform(0.1, 0.5) * HEIGHT)
        base_px = random.uniform(0.03, 0.14) * WIDTH - across * x - down * y
        found.append(slanted_plane(0, region, base_px, across, down))
    return found


def _rod(x0: float, y0: float, half_px: float, slope: float, reach_px: float) -> Callable[..., np.ndarray]:
    return lambda x, y: (np.abs(x - x0 - slope * (y - y0)) < half_px) & (np.abs(y - y0) < reach_px)


def _material(random: np.random.Generator) -> Float64[np.ndarray, "h w"]:
    """Return a texture of some contrast, from next to none to strong, with patches of other grey or blank ones."""
    shape = TILE_PX, TILE_PX
    names = list(FAMILIES)
    values = np.zeros(shape)
    for _ in range(random.integers(1, 3)):
        each = FAMILIES[names[random.integers(len(names))]](shape, random)
        values += (each - each.mean()) / max(float(each.std()), 1e-9)
    values *= random.choice([random.uniform(0, 3), random.uniform(2, 12), random.uniform(10, 40)])
    if random.random() < 0.5:
        values += random.uniform(5, 40) * smooth_noise(shape, random, random.uniform(10, 60))
    if random.random() < 0.3:
        values *= smooth_noise(shape, random, 25) > random.uniform(-0.5, 1)
    return values + random.uniform(30, 220)


def _view(surfaces: list[Surface], materials: list[np.ndarray], where: Where) -> Float64[np.ndarray, "h w"]:
    grey = np.zeros((HEIGHT, WIDTH))
    rows, columns = np.indices(grey.shape, np.float64)
    for down in (np.arange(POINTS) + 0.5) / POINTS - 0.5:
        for across in (np.arange(POINTS) + 0.5) / POINTS - 0.5:
            y = rows + down
            places = [where(surface, columns + across, y) for surface in surfaces]
            depths = [
                np.where(surface.region(x, y), surface.disparity_px(x, y), -np.inf)
                for surface, x in zip(surfaces, places, strict=True)
            ]
            nearest = np.argmax(depths, axis=0)
            for index, (material, x) in enumerate(zip(materials, places, strict=True)):
                shown = nearest == index
                grey[shown] += _sampled(material, x[shown], y[shown])
    return grey / POINTS**2


def _sampled(material: np.ndarray, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    left, top = np.floor(x).astype(int), np.floor(y).astype(int)
    u, v = x - left, y - top
    rows, columns = (top % TILE_PX, (top + 1) % TILE_PX), (left % TILE_PX, (left + 1) % TILE_PX)
    upper, lower = ((1 - u) * material[row, columns[0]] + u * material[row, columns[1]] for row in rows)
    return (1 - v) * upper + v * lower


def _photographed(views: list[np.ndarray], random: np.random.Generator) -> list[np.ndarray]:
    """Return the views under uneven light, by cameras that differ, blur, and add noise; some pass through JPEG."""
    import cv2

    shape = HEIGHT, WIDTH
    light = np.exp(0.25 * random.random() * smooth_noise(shape, random, 80))
    left, right = (view * light for view in views)
    if random.random() < 0.4:  # gloss
        right = right + random.uniform(0, 6) * smooth_noise(shape, random, random.uniform(5, 60))
    if random.random() < 0.3:
        right = random.uniform(0.85, 1.1) * right + random.uniform(-6, 6)
    if random.random() < 0.3:
        blur_px = random.uniform(0.3, 0.9)
        left, right = (cv2.GaussianBlur(view, (0, 0), blur_px) for view in (left, right))
    noise = random.choice(NOISES, p=HOW_OFTEN)
    found = [
        np.rint(np.clip(view + noise * random.standard_normal(shape), 0, 255)).astype(np.uint8)
        for view in (left, right)
    ]
    if random.random() < 0.2:
        options = [cv2.IMWRITE_JPEG_QUALITY, int(random.uniform(60, 95))]
        packed = [cv2.imencode(".jpg", view, options)[1] for view in found]
        found = [np.asarray(cv2.imdecode(each, cv2.IMREAD_GRAYSCALE)) for each in packed]
    return found
