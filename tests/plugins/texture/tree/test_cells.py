"""Cells of a picture, and the shares of each kind that they hold."""

import numpy as np
import pytest

from tangible_texture.tree.cells import CELLS, opponent_colours, reduce_to_cells, shares


def paint(shape: tuple[int, int] = (20, 30), channels: int = 3, seed: int = 0) -> np.ndarray:
    return np.random.default_rng(seed).random((*shape, channels)).astype(np.float32)


@pytest.mark.parametrize(("shape", "cells"), [((1, 1), (1, 1)), ((200, 200), (200, 200)), ((600, 300), (283, 141))])
def test_large_picture_is_reduced_to_at_most_the_cells_in_its_proportions(
    shape: tuple[int, int], cells: tuple[int, int]
):
    found = reduce_to_cells(paint(shape)).shape
    assert found == (*cells, 3)
    assert found[0] * found[1] <= CELLS * 1.01


def test_cell_is_the_mean_of_its_pixels():
    picture = paint((800, 800), 1)
    cells = reduce_to_cells(picture)
    assert cells.shape == (200, 200, 1)
    assert cells[..., 0] == pytest.approx(picture.reshape(200, 4, 200, 4).mean(axis=(1, 3)), abs=1e-5)


def test_opponent_colours_of_pure_colours_are_exact():
    picture = np.array([[[0, 0, 0], [1, 1, 1]], [[1, 0, 0], [0, 0, 1]]], np.float32)
    colours = opponent_colours(picture)
    assert colours is not None
    assert (
        pytest.approx(np.array([[0, 0, 0], [1, 0, 0], [0.299, 1, 0.5], [0.114, 0, -1]]), abs=1e-6)
        == colours.reshape(3, 4).T
    )


def test_grey_picture_has_no_colour():
    colours = opponent_colours(paint(channels=1))
    assert colours is not None
    assert not colours[1:].any()
    assert (colours[0].min(), colours[0].max()) == (0, 1)


def test_picture_without_range_has_no_colours():
    assert opponent_colours(np.full((5, 6, 3), 0.3, np.float32)) is None


def test_single_rare_values_do_not_set_the_range():
    picture = paint((100, 100), 1)
    torn = picture.copy()
    torn[3, 4] = 50
    one, other = opponent_colours(picture), opponent_colours(torn)
    assert one is not None
    assert other is not None
    assert np.abs(np.delete(one - other, 3, axis=1)).max() < 0.01


@pytest.mark.parametrize(("gain", "offset"), [(1000, 0), (1, 5), (1e-3, -2)])
def test_shares_do_not_depend_on_gain_and_offset(gain: float, offset: float):
    one, other = (opponent_colours(each) for each in (paint(), paint() * np.float32(gain) + np.float32(offset)))
    assert one is not None
    assert other is not None
    assert other == pytest.approx(one, abs=2e-3)


def test_negative_has_the_same_shares_in_reverse_order():
    one, other = (opponent_colours(each) for each in (paint(), 1 - paint()))
    assert one is not None
    assert other is not None
    positive, negative = shares(one), shares(other)
    for name in ("brightness", "red", "yellow"):
        assert negative[name] == pytest.approx(positive[name][::-1], abs=1e-4), name
    for name in ("roughness", "direction"):
        assert negative[name] == pytest.approx(positive[name], abs=1e-3), name


def test_shares_of_each_kind_sum_to_one():
    colours = opponent_colours(paint())
    assert colours is not None
    for name, planes in shares(colours).items():
        assert planes.sum(axis=0) == pytest.approx(np.ones(planes.shape[1:]), abs=1e-4), name
        assert planes.min() >= 0, name


def test_value_is_divided_between_the_two_nearest_bins():
    colours = np.zeros((3, 1, 3), np.float32)
    colours[0] = [[0, 0.25 / 11, 1]]
    found = shares(colours)["brightness"][:, 0]
    assert found[:2, 1].tolist() == pytest.approx([0.75, 0.25])
    assert (found[0, 0], found[-1, 2], found[2:, 1].max()) == (1, 1, 0)


@pytest.mark.parametrize(
    ("across", "down", "way"),
    [(1, 0, 0), (0, 1, 1), (1, 1, 2), (1, -1, 3)],
    ids=["across", "down", "rising", "falling"],
)
def test_slope_in_one_direction_has_that_share_alone(across: int, down: int, way: int):
    rows, columns = np.indices((12, 12), np.float32)
    colours = np.zeros((3, 12, 12), np.float32)
    colours[0] = (across * columns + down * rows) / 10
    inner = shares(colours)["direction"][:, 2:-2, 2:-2]
    assert inner[way].min() > 0.8
    assert np.delete(inner, [way, 4], axis=0).max() < 1e-6


def test_smooth_cells_have_less_roughness_than_noisy_ones():
    colours = np.full((3, 40, 80), 0.5, np.float32)
    colours[0, :, 40:] += np.random.default_rng(0).normal(0, 0.1, (40, 40))
    rough = shares(colours)["roughness"]
    mean = (np.arange(len(rough))[:, None, None] * rough).sum(axis=0)
    assert mean[:, :30].max() < 1e-6
    assert mean[:, 46:].min() > 2
