"""Pictures of wavy cells, whose segments are known."""

import numpy as np

from tangible_texture.regions.merging import number_in_reading_order
from tangible_texture.signal.smoothing import gaussian


def cells(seed: int, count: int = 10, size: int = 256) -> np.ndarray:
    """Labels of wavy cells, each of one piece: the nearest of points on a shaken grid."""
    rng = np.random.default_rng(seed)
    rows, columns = np.indices((size, size)) / size
    waves = [0.02 * np.sin(2 * np.pi * (3 * each + rng.random())) for each in (columns, rows)]
    points = np.array([(row + 0.5, column + 0.5) for row in range(4) for column in range(4)]) / 4
    points = (points + rng.uniform(-0.08, 0.08, points.shape))[rng.permutation(16)[:count]]
    far = (rows + waves[0])[..., None] - points[:, 0], (columns + waves[1])[..., None] - points[:, 1]
    return number_in_reading_order(np.hypot(*far).argmin(axis=2).astype(np.int32))


def smooth_scene(seed: int, noise: float) -> tuple[np.ndarray, np.ndarray]:
    """A picture of 8 bits, smooth in each cell: grey levels 18 apart, a shading across, a soft edge, and noise."""
    labels = cells(seed)
    rng = np.random.default_rng(seed)
    rows, columns = np.indices(labels.shape) / len(labels)
    grey = rng.permutation(np.linspace(35, 215, labels.max() + 1))[labels] + 8 * rows - 12 * columns
    soft = gaussian(grey[..., None].astype(np.float32), 0.8)[..., 0]
    return np.clip(np.rint(soft + rng.normal(0, noise, soft.shape)), 0, 255).astype(np.uint8), labels
