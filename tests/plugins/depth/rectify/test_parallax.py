"""A wall seen from two places, and a camera that turned on the spot, told apart by their homography alone."""

import numpy as np
import pytest

from tangible_depth.rectify.homographies import camera_matrix, rotation
from tangible_depth.rectify.parallax import best_plane, is_pure_rotation

SHAPE = (750, 1000)


def flat_matches(seed, focal, shift_px, noise_px, zoom=1.0, slant=0.4, turn=0.03):
    """Matches of a randomly slanted wall by slightly rotated cameras; the focal length is in widths."""
    random = np.random.default_rng(seed)
    camera = camera_matrix(focal * SHAPE[1], SHAPE)
    other = camera_matrix(zoom * focal * SHAPE[1], SHAPE)
    pixels = np.column_stack([random.uniform(0, [SHAPE[1], SHAPE[0]], (200, 2)), np.ones(200)])
    rays = pixels @ np.linalg.inv(camera).T
    points = rays * (5 / (1 + rays @ [*random.uniform(-slant, slant, 2), 0]))[:, None]
    moved = points @ rotation(*random.normal(0, turn, 3)).T - [5 * shift_px / (focal * SHAPE[1]), 0, 0]
    found = [seen[:, :2] / seen[:, 2:] for seen in (points @ camera.T, moved @ other.T)]
    return [each + random.normal(0, noise_px, each.shape) for each in found]


@pytest.mark.parametrize("seed", range(1, 12, 2))
@pytest.mark.parametrize("focal", [0.6, 1.0, 2.0])
@pytest.mark.parametrize("zoom", [1.0, 1.1])
def test_rotated_camera_is_recognised(seed, focal, zoom):
    matches = flat_matches(seed, focal, 0.0, 0.3, zoom)
    assert is_pure_rotation(best_plane(*matches, 1.0), *matches, SHAPE)


@pytest.mark.parametrize("seed", range(1, 12, 2))
@pytest.mark.parametrize(("focal", "shift_px"), [(0.6, 10), (1.0, 10), (2.0, 40)])
def test_wall_from_two_places_is_not_a_rotated_camera(seed, focal, shift_px):
    matches = flat_matches(seed, focal, shift_px, 0.3)
    assert not is_pure_rotation(best_plane(*matches, 1.0), *matches, SHAPE)


@pytest.mark.parametrize("seed", range(1, 12, 2))
def test_frontal_wall_is_not_a_rotated_camera_of_infinite_focal_length(seed):
    matches = flat_matches(seed, 1.0, 40, 0.3, slant=0.0, turn=0.0)
    assert not is_pure_rotation(best_plane(*matches, 1.0), *matches, SHAPE)
