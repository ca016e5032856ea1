"""The eight-point method at the size of a large camera's pictures."""

import numpy as np

from tangible_depth.rectify.fundamental import eight_point
from tangible_depth.rectify.homographies import camera_matrix, rotation

from .figures import Figure
from .tests_path import two_cameras

WIDTH_PX, HEIGHT_PX, NOISE_PX, POINTS, SCENES = 6000, 4500, 0.5, 300, 50


def figures() -> list[Figure]:
    """Distance of exact points from the epipolar lines of an F that was made of noisy ones."""
    medians = [_median(seed) for seed in range(SCENES)]
    return [
        Figure(
            f"8-point, {WIDTH_PX} px wide, {NOISE_PX} px noise, {POINTS} matches",
            "<= 0.1 px median",
            f"{np.median(medians):.3f} px, median of {SCENES} scenes (worst {max(medians):.3f})",
            float(np.median(medians)) <= 0.1,
        )
    ]


def _median(seed: int) -> float:
    random = np.random.default_rng(seed)
    true = _points(random)
    noisy = [each + random.normal(0, NOISE_PX, each.shape) for each in true]
    return float(np.median(two_cameras.symmetric_epipolar_distance(eight_point(*noisy), *true))) / np.sqrt(2)


def _points(random: np.random.Generator) -> list[np.ndarray]:
    """Left and right pixels of points 3 to 8 m away; the cameras stand 0.3 m apart and turn towards each other."""
    camera = camera_matrix(0.9 * WIDTH_PX, (HEIGHT_PX, WIDTH_PX))
    pixels = np.column_stack([random.uniform(0, [WIDTH_PX, HEIGHT_PX], (POINTS, 2)), np.ones(POINTS)])
    points = random.uniform(3, 8, (POINTS, 1)) * (pixels @ np.linalg.inv(camera).T)
    moved = points @ rotation(0.02, -0.05, 0.01).T + [-0.3, 0.02, 0.05]
    return [seen[:, :2] / seen[:, 2:] for seen in (points @ camera.T, moved @ camera.T)]
