"""Pairs with exact disparity: textures are functions of the plane, so that any fraction of a pixel is exact."""

from functools import cache

import numpy as np

from tangible_core.data import Views
from tangible_core.testing.synthetic.stereo_scenes import synthetic_pair

known_pair = cache(synthetic_pair)
"""Drawn once for all tests of a process, as the pairs below: to draw one takes longer than many a match."""


def texture(x, y, seed=0):
    """Grey values 0..255 at any place: 60 plane waves, 3 to 20 px long."""
    rng = np.random.default_rng(seed)
    total = np.zeros(np.broadcast(x, y).shape)
    for _ in range(60):
        wave, angle, phase = 2 * np.pi / rng.uniform(3, 20), rng.uniform(0, np.pi), rng.uniform(0, 2 * np.pi)
        total += np.cos(wave * (np.cos(angle) * x + np.sin(angle) * y) + phase)
    return np.clip(np.rint(127.5 + 16 * total), 0, 255).astype(np.uint8)


@cache
def slanted(shape=(96, 160), across=0.0, down=0.0, offset=7.25, seed=0):
    """A plane of disparity across x + down y + offset: the views, and the disparity of the left one."""
    y, x = np.indices(shape, float)
    right = texture((x + down * y + offset) / (1 - across), y, seed)
    return Views(texture(x, y, seed), right), _read_only((across * x + down * y + offset).astype(np.float32))


@cache
def step(shape=(96, 160), back=4, front=16, box=(24, 72, 60, 120)):
    """A rectangle (top, bottom, left, right) before a wall: views, disparity, what the right view hides."""
    y, x = np.indices(shape, float)

    def inside(u):
        return (box[0] <= y) & (y < box[1]) & (box[2] <= u) & (u < box[3])

    left = np.where(inside(x), texture(x, y, 1), texture(x, y, 2))
    right = np.where(inside(x + front), texture(x + front, y, 1), texture(x + back, y, 2))
    disparity = np.where(inside(x), front, back).astype(np.float32)
    hidden = (~inside(x) & inside(x - back + front)) | (x < disparity)
    return Views(left, right), _read_only(disparity), _read_only(hidden)


def _read_only(array):
    array.flags.writeable = False
    return array
