"""Rotations, cameras and lines against the formulas: with a sign wrong, raw pairs are bent instead of aligned."""

import numpy as np
import pytest

from tangible_depth.rectify.fundamental import best_plane, sampson_distance
from tangible_depth.rectify.projective import camera_matrix, inverse, is_pure_rotation, rotation
from tangible_depth.rectify.rectifying_rotation import epipoles
from tangible_depth.sparse.matches import Matches


def test_inverse_of_any_matrix_is_numpys():
    matrix = np.random.default_rng(0).normal(size=(3, 3))
    assert inverse(matrix) == pytest.approx(np.linalg.inv(matrix))
    assert inverse(camera_matrix(900.0, (40, 70))) == pytest.approx(np.linalg.inv(camera_matrix(900.0, (40, 70))))


def test_rotation_turns_about_x_then_y_then_z():
    assert rotation(np.pi / 2, 0, 0) @ [0, 1, 0] == pytest.approx([0, 0, 1])
    assert rotation(0, np.pi / 2, 0) @ [0, 0, 1] == pytest.approx([1, 0, 0])
    assert rotation(0, 0, np.pi / 2) @ [1, 0, 0] == pytest.approx([0, 1, 0])
    apart = rotation(0, 0, 0.4) @ rotation(0, 0.5, 0) @ rotation(0.6, 0, 0)
    assert rotation(0.6, 0.5, 0.4) == pytest.approx(apart)


def skew(v):
    return np.array([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]])


def test_distances_are_those_of_points_from_their_lines():
    random = np.random.default_rng(0)
    matrix = random.normal(size=(3, 3))
    left, right = random.normal(size=(2, 50, 2))
    rows = [np.column_stack([each, np.ones(50)]) for each in (left, right)]
    in_left, in_right = rows[1] @ matrix.T, rows[0] @ matrix
    value = np.einsum("ni,ni->n", rows[0], in_left)
    to_left, to_right = (value / np.hypot(*each[:, :2].T) for each in (in_left, in_right))
    # Both share the numerator: 1 / sampson^2 = 1 / d_left^2 + 1 / d_right^2.
    assert sampson_distance(matrix, Matches(left, right)) ** -2 == pytest.approx(to_left**-2 + to_right**-2)


def test_epipoles_of_known_cameras_are_exact():
    # P_left = [I | 0], P_right = [I | t]: right = left + t / depth, F = [t]x up to the convention's transpose.
    move = np.array([0.3, -0.2, 0.5])
    left, right = epipoles(skew(move))
    for epipole in (left, right):
        assert np.cross(epipole, move) == pytest.approx(np.zeros(3), abs=1e-12)


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
    return Matches(*(each + random.normal(0, noise_px, each.shape) for each in found))


@pytest.mark.parametrize("seed", [1, 5])
@pytest.mark.parametrize("focal", [0.6, 1.0, 2.0])
@pytest.mark.parametrize("zoom", [1.0, 1.1])
def test_rotated_camera_is_recognised(seed, focal, zoom):
    matches = flat_matches(seed, focal, 0.0, 0.3, zoom)
    assert is_pure_rotation(best_plane(matches, 1.0), matches, SHAPE)


@pytest.mark.parametrize("seed", [1, 5])
@pytest.mark.parametrize(("focal", "shift_px"), [(0.6, 10), (1.0, 10), (2.0, 40)])
def test_wall_from_two_places_is_not_a_rotated_camera(seed, focal, shift_px):
    matches = flat_matches(seed, focal, shift_px, 0.3)
    assert not is_pure_rotation(best_plane(matches, 1.0), matches, SHAPE)


@pytest.mark.parametrize("seed", [1, 5])
def test_frontal_wall_is_not_a_rotated_camera_of_infinite_focal_length(seed):
    matches = flat_matches(seed, 1.0, 40, 0.3, slant=0.0, turn=0.0)
    assert not is_pure_rotation(best_plane(matches, 1.0), matches, SHAPE)
