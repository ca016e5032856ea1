"""Cameras, lines and the fundamental matrix from matches: else raw pairs are bent by wrong ones."""

from contextlib import nullcontext

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tangible_depth.rectify.fundamental import (
    DegenerateMatches,
    best_plane,
    check_matches,
    eight_point,
    fundamental_from_plane,
    normalise,
    pixel_weights,
    robust_fundamental,
    sampson_distance,
)
from tangible_depth.rectify.projective import camera_matrix, inverse, is_pure_rotation, rotation
from tangible_depth.rectify.rectifying_rotation import epipoles
from tangible_depth.sparse.matches import Matches
from two_cameras import seen_points, some_wrong


def test_normalised_points_are_centred_with_a_mean_distance_of_root_two():
    points, transform = normalise(seen_points()[0])
    assert points[:, :2].mean(axis=0) == pytest.approx([0, 0], abs=1e-12)
    assert np.linalg.norm(points[:, :2], axis=1).mean() == pytest.approx(np.sqrt(2))
    assert points == pytest.approx(np.column_stack([seen_points()[0], np.ones(300)]) @ transform.T)


@given(
    turn=st.tuples(*[st.floats(-0.2, 0.2)] * 3),
    move=st.tuples(st.floats(0.2, 1), st.floats(-0.3, 0.3), st.floats(-0.3, 0.3)),
    count=st.integers(9, 60),
)
def test_exact_points_give_their_geometry(turn, move, count):
    matches = seen_points(turn, move, count)
    matrix = eight_point(matches)
    assert np.linalg.norm(matrix) == pytest.approx(1)
    assert np.linalg.svd(matrix, compute_uv=False)[2] < 1e-12
    assert sampson_distance(matrix, matches).max() < 1e-4


@pytest.mark.parametrize("share", [0.0, 0.3, 0.6])
def test_wrong_matches_are_outliers(share):
    noisy = seen_points(count=400, noise_px=0.3)
    found = robust_fundamental(some_wrong(*noisy, share), threshold_px=1.5)
    wrong = round(share * 400)
    assert found.inliers[wrong:].mean() > 0.97
    assert found.inliers[:wrong].mean() < 0.1 if wrong else True
    assert np.median(sampson_distance(found.matrix, seen_points(count=400))) < 0.1


def reason(call, *matches):
    return refusal(call, *matches).reason


def refusal(call, *matches):
    with pytest.raises(DegenerateMatches) as caught:
        call(Matches(*matches))
    return caught.value


@pytest.mark.parametrize("call", [eight_point, robust_fundamental])
def test_degenerate_matches_are_refused_with_their_reason(call):
    assert reason(call, *seen_points(count=7)) == "too few"
    assert reason(call, np.empty((0, 2)), np.empty((0, 2))) == "too few"
    left, right = seen_points(count=5)
    assert reason(call, np.tile(left, (9, 1)), np.tile(right, (9, 1))) == "duplicate"
    seven, eight = (np.tile(seen_points(count=count)[0], (2, 1)) for count in (7, 8))
    assert "7 different points in 14" in str(refusal(call, seven, seven))
    assert reason(call, eight, eight) == "homography"
    assert reason(call, np.ones((30, 2)), np.ones((30, 2))) == "duplicate"
    along, scattered = np.linspace(0, 700, 40), seen_points(count=40)[0]
    line = np.column_stack([along, 0.5 * along + 3])
    assert reason(call, line, line + np.array([5, 1])) == reason(call, scattered, line) == "collinear"
    assert "the right points" in str(refusal(call, scattered, line))
    assert "the left points" in str(refusal(call, line, scattered))
    for value in (np.nan, np.inf):
        left, right = seen_points()
        right[7, 1] = value
        assert reason(call, left, right) == "not finite"
        left[7, 0], right[9] = value, value
        assert f"2 of {len(left)} matches are" in str(refusal(call, left, right))


@pytest.mark.parametrize("share", [0.0, 0.3])
@pytest.mark.parametrize("count", [30, 500])
def test_missing_parallax_is_detected_among_noise_and_wrong_matches(share, count):
    flat = seen_points(count=count, flat=True, noise_px=0.3)
    turned = seen_points(count=count, move_m=(0, 0, 0), noise_px=0.3)
    assert reason(robust_fundamental, *some_wrong(*flat, share)) == "homography"
    assert reason(robust_fundamental, *some_wrong(*turned, share)) == "homography"


def before_a_wall(off, wrong, seed):
    """Matches of a wall, then `off` ones of a thing before it; and as many as `wrong` of chance among the first."""
    cameras = {"turn": (0.02, -0.05, 0.05), "move_m": (-0.3, 0.02, 0.01)}
    wall = some_wrong(*seen_points(**cameras, count=600, flat=True, noise_px=0.1, seed=seed), wrong / 600)
    thing = seen_points(**cameras, count=off, noise_px=0.1, seed=seed + 100)
    return Matches(*(np.vstack(each) for each in zip(wall, thing, strict=True)))


@pytest.mark.parametrize("seed", [1, 5])
def test_few_matches_before_a_wall_determine_the_geometry(seed):
    found = robust_fundamental(before_a_wall(20, 60, seed))
    assert found.inliers[-20:].all()


def test_two_matches_before_a_plane_determine_the_epipole():
    matches = before_a_wall(12, 12, 1)
    plane, off = best_plane(matches, 1.0), matches.select(slice(-12, None))
    assert plane is not None
    matrix = fundamental_from_plane(plane, matches, 1.0)
    true = eight_point(seen_points(turn=(0.02, -0.05, 0.05), move_m=(-0.3, 0.02, 0.01)))
    assert sampson_distance(matrix, off).max() <= 1
    assert np.median(sampson_distance(matrix, seen_points(turn=(0.02, -0.05, 0.05), move_m=(-0.3, 0.02, 0.01)))) <= 1
    assert np.median(sampson_distance(true, off)) <= 1


@pytest.mark.parametrize("count", [9, 30, 200, 1000])
def test_chance_matches_are_outliers(count):
    random = np.random.default_rng(count)
    assert reason(robust_fundamental, *random.uniform(0, 700, (2, count, 2))) == "outliers"


def test_equations_are_weighed_by_the_lengths_of_both_lines():
    matches = seen_points(count=30)
    matrix = np.random.default_rng(0).normal(size=(3, 3))
    rows = [np.column_stack([match, np.ones(30)]) for match in matches]
    value = np.abs(np.einsum("ni,ij,nj->n", rows[0], matrix, rows[1]))
    weights = pixel_weights(matrix, matches)
    assert weights.max() == 1
    ratio = weights * value / sampson_distance(matrix, matches)
    assert ratio == pytest.approx(np.full(30, ratio[0]))


@pytest.mark.parametrize(("share", "refused"), [(0.0045, True), (0.0055, False)])
def test_points_within_half_a_percent_of_a_line_are_collinear(share, refused):
    along, across = np.linspace(-300, 300, 40), np.random.default_rng(0).normal(size=40)
    across -= across.mean() + along * (along @ across) / (along @ along)
    across *= share * np.linalg.norm(along) / np.linalg.norm(across)
    turn = np.array([[0.8, -0.6], [0.6, 0.8]])
    with pytest.raises(DegenerateMatches, match="collinear") if refused else nullcontext():
        check_matches(Matches(np.column_stack([along, across]) @ turn + 400, seen_points(count=40)[0]))


def test_inverse_is_numpys_and_rotation_turns_about_x_then_y_then_z():
    matrix = np.random.default_rng(0).normal(size=(3, 3))
    assert inverse(matrix) == pytest.approx(np.linalg.inv(matrix))
    assert inverse(camera_matrix(900.0, (40, 70))) == pytest.approx(np.linalg.inv(camera_matrix(900.0, (40, 70))))
    assert rotation(np.pi / 2, 0, 0) @ [0, 1, 0] == pytest.approx([0, 0, 1])
    assert rotation(0, np.pi / 2, 0) @ [0, 0, 1] == pytest.approx([1, 0, 0])
    assert rotation(0, 0, np.pi / 2) @ [1, 0, 0] == pytest.approx([0, 1, 0])
    apart = rotation(0, 0, 0.4) @ rotation(0, 0.5, 0) @ rotation(0.6, 0, 0)
    assert rotation(0.6, 0.5, 0.4) == pytest.approx(apart)


def skew(v):
    return np.array([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]])


def test_distances_and_epipoles_of_known_cameras_are_exact():
    random = np.random.default_rng(0)
    matrix = random.normal(size=(3, 3))
    left, right = random.normal(size=(2, 50, 2))
    rows = [np.column_stack([each, np.ones(50)]) for each in (left, right)]
    in_left, in_right = rows[1] @ matrix.T, rows[0] @ matrix
    value = np.einsum("ni,ni->n", rows[0], in_left)
    to_left, to_right = (value / np.hypot(*each[:, :2].T) for each in (in_left, in_right))
    # Both share the numerator: 1 / sampson^2 = 1 / d_left^2 + 1 / d_right^2.
    assert sampson_distance(matrix, Matches(left, right)) ** -2 == pytest.approx(to_left**-2 + to_right**-2)
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
@pytest.mark.parametrize(
    ("focal", "shift_px", "slant", "turn"),
    [(0.6, 10, 0.4, 0.03), (1.0, 10, 0.4, 0.03), (2.0, 40, 0.4, 0.03), (1.0, 40, 0.0, 0.0)],
)
def test_wall_from_two_places_is_not_a_rotated_camera(seed, focal, shift_px, slant, turn):
    """A frontal wall is not one of infinite focal length either."""
    matches = flat_matches(seed, focal, shift_px, 0.3, slant=slant, turn=turn)
    assert not is_pure_rotation(best_plane(matches, 1.0), matches, SHAPE)
