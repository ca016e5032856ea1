"""Rotations and cameras, with the signs and the order that the formulas say."""

import numpy as np
import pytest

from tangible_depth.rectify.homographies import camera_matrix, inverse, rotation


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


def test_camera_looks_through_the_middle_of_a_picture():
    assert camera_matrix(900.0, (41, 71)).tolist() == [[900, 0, 35], [0, 900, 20], [0, 0, 1]]
