"""Label maps of clusters, and the seams between them."""

import numpy as np
import pytest

from tangible_core.plugins.notes import collected
from tangible_texture.energies.noise_floor import is_flat, is_one_texture
from tangible_texture.features.seams import remove_seams
from tangible_texture.kmeans.labelling import choose_segments, label_map_of_cells, margins, segment_by_kmeans
from tangible_texture.regions.merging import number_in_reading_order


def test_labels_renumbered_are_in_the_order_of_their_first_pixels():
    assert number_in_reading_order(np.array([[3, 3, 0], [7, 0, 3]], np.int32)).tolist() == [[0, 0, 1], [2, 1, 0]]


def test_cells_at_full_size_repeat_label_and_confidence():
    found = label_map_of_cells(np.array([[1, 0]], np.int32), np.array([0.25, 1], np.float32), 3, (2, 5))
    assert found.labels.tolist() == [[0, 0, 0, 1, 1]] * 2
    assert found.confidence.tolist() == [[0.25] * 3 + [1] * 2] * 2


def test_margins_are_1_at_a_centre_and_0_half_way():
    centres = np.array([[0, 0], [4, 0], [100, 0]], np.float32)
    rows = np.array([[0, 0], [1, 0], [2, 0], [4, 0]], np.float32)
    assert margins(rows, centres) == pytest.approx([1, 2 / 3, 0, 1])
    assert margins(rows, centres[:1]).tolist() == [1] * 4


def test_segments_under_auto_are_estimated_and_reported():
    rows = np.repeat(np.eye(3, dtype=np.float32) * 9, 20, axis=0)
    with collected() as notes:
        assert choose_segments(rows, 5, 0) == 5
        assert choose_segments(rows, "auto", 0) == 3
    [message] = notes
    assert message.startswith("segments: 3, estimated with confidence")


def test_features_in_two_halves_are_two_segments():
    features = np.zeros((4, 6, 2), np.float32)
    features[:, 4:] = 1
    found = segment_by_kmeans(features, 2, (7, 12), 5, seed=0)
    assert np.array_equal(found.labels, (np.arange(12) >= 8).astype(np.int32)[None].repeat(7, axis=0))
    assert (found.confidence == 1).all()


def test_picture_of_rounding_or_one_pixel_is_flat():
    assert is_flat(np.full((9, 9), np.float32(0.1)))
    assert is_flat(np.float32(1e20) * (1 + 1e-7 * np.random.default_rng(0).random((9, 9))).astype(np.float32))
    assert is_flat((np.arange(81) == 40).astype(np.float32).reshape(9, 9))
    assert not is_flat(np.float32(1e-20) * (np.indices((9, 9))[0] > 4).astype(np.float32))


def test_features_equal_or_too_coarse_are_one_texture():
    grey = np.random.default_rng(0).random((64, 64)).astype(np.float32)
    even = np.ones((3, 16, 16), np.float32)
    assert is_one_texture(even, 1, grey)
    halves = even + (np.arange(16) > 7)
    assert not is_one_texture(halves, 1, grey)
    folded = np.pad(0.001 * halves[:, 4:-4, 4:-4], ((0, 0), (4, 4), (4, 4)), constant_values=1)
    assert is_one_texture(folded, 1, grey)
    framed = np.pad(0 * grey[16:-16, 16:-16], 16, constant_values=1) * grey
    assert not is_one_texture(folded, 1, framed)


@pytest.mark.parametrize(("spread", "one"), [(0.02, True), (0.05, False), (0.16, False)])
def test_features_spread_by_under_three_percent_are_one_texture(spread: float, one: bool):
    grey = np.random.default_rng(0).random((64, 64)).astype(np.float32)
    checks = np.indices((16, 16)).sum(axis=0) % 2 * 2 - 1
    assert is_one_texture((1 + spread * checks)[None].astype(np.float32), 0.25, grey) == one


def test_a_narrow_strip_goes_to_its_neighbours():
    labels = np.repeat([0, 2, 1], [20, 4, 20]).astype(np.int32)[None].repeat(30, axis=0)
    found, same = remove_seams(labels, 3)
    assert np.array_equal(found, np.repeat([0, 1], 22).astype(np.int32)[None].repeat(30, axis=0))
    assert np.array_equal(same, labels != 2)
    assert np.array_equal(remove_seams(labels, 1)[0], labels)


def test_wide_segments_stay_up_to_the_frame():
    labels = (np.arange(40) >= 12).astype(np.int32)[None].repeat(40, axis=0)
    found, same = remove_seams(labels, 5)
    assert np.array_equal(found, labels)
    assert same.all()


@pytest.mark.parametrize("shape", [(1, 1), (2, 9), (5, 3)])
def test_a_picture_smaller_than_the_disc_stays(shape):
    labels = np.zeros(shape, np.int32)
    assert np.array_equal(remove_seams(labels, 4)[0], labels)
    checks = (np.indices(shape).sum(axis=0) % 2).astype(np.int32)
    found, same = remove_seams(checks, 1)
    assert np.array_equal(found, checks) or same.any()
