"""Surfaces that break a careless force law: cliffs, noise, spikes, walls, a sharp ridge."""

import numpy as np
from jaxtyping import Float64

from tangible_core.data import HapticSurface
from tangible_core.testing.synthetic.scenes import ridge, waves


def rough_surfaces(count: int = 128) -> dict[str, HapticSurface]:
    """Return surfaces by name, 80 mm wide, of count x count cells, the same in every run."""
    random, index = np.random.default_rng(3), np.arange(count)
    noise = random.uniform(0, 1, (count, count))
    spikes, walls = np.zeros((2, count, count))
    spikes[random.integers(0, count, 2 * count), random.integers(0, count, 2 * count)] = 0.01
    walls[:, count // 3] = walls[count // 2] = 0.008
    heights: dict[str, Float64[np.ndarray, "h w"]] = {
        "checker": (index[:, None] * 16 // count + index[None] * 16 // count) % 2 * 0.004,
        "8-bit noise": np.rint(_smooth(noise) * 255) / 255 * 0.004,
        "white noise": noise * 0.004,
        "spikes": spikes,
        "walls": walls,
    }
    known = {"ridge": ridge(1.5, 0.06, (count, count)).surface, "waves": waves(shape=(count, count)).surface}
    return {name: HapticSurface.from_heights(height) for name, height in heights.items()} | known


def _smooth(noise: Float64[np.ndarray, "h w"]) -> Float64[np.ndarray, "h w"]:
    """Return the means of three neighbours, wrapped around."""
    return (noise + np.roll(noise, 1, axis=0) + np.roll(noise, 1, axis=1)) / 3
