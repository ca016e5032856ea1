"""Stereo pairs whose disparity and occlusion are known exactly: planes, steps, spheres and thin bars."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float32

from ...data import Record, Views
from .surfaces import (
    Surface,
    cap,
    everywhere,
    left_view,
    rectangle,
    right_view,
    slanted_plane,
    true_disparity,
    truly_visible,
)

FAR, NEAR = 0.02, 0.1
"""Disparities of a scene, as shares of its width."""
BAR_WIDTHS_PX = (1.5, 2.0, 3.0, 5.0, 8.0)
BACKGROUND, FIRST = 1, 2
"""Seeds of textures within a scene."""


@dataclass(frozen=True, eq=False)
class KnownPair(Record):
    """A pair and its truth: disparity in px of every left pixel, and whether the right view shows it too."""

    views: Views
    truth_px: Float32[np.ndarray, "h w"]
    visible: Bool[np.ndarray, "h w"]


def synthetic_pair(name: str, width_px: int = 480, height_px: int = 360, seed: int = 0) -> KnownPair:
    """Return one of SCENES in uint8 grey; layout and textures follow from the seed.

    Raises: KeyError if no scene has this name.
    """
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
