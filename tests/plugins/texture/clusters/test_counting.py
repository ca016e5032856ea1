"""The estimate of the number of textures."""

from math import exp, log

import numpy as np
import pytest

from tangible_core.plugins.notes import collected
from tangible_texture.clusters.counting import Weights, largest_number, likeliest_division, number_likelihoods
from tangible_texture.clusters.joining import Step

LAST = (np.inf, 0.0)


def steps(*pairs: tuple[float, float], cells: int = 16384) -> list[Step]:
    """Return divisions down to one cluster, from the distance and size of each next joining."""
    counts = range(len(pairs) + 1, 0, -1)
    labels = np.arange(cells, dtype=np.int32)
    return [Step(labels % count, count, 1.0, *each) for count, each in zip(counts, (*pairs, LAST), strict=True)]


def test_probability_of_a_number_is_that_of_all_joinings_before_and_not_of_the_next():
    """Log-odds here: 0.5 + log D + 2 log size + 3 log cells."""
    weights = Weights(constant=0.5, distance=1, size=2, cells=3)
    odds = [0.5 + log(distance) + 2 * log(size) + 3 * log(4) for distance, size in ((1, 0.25), (2, 0.125), (3, 0.125))]
    two = [1 / (1 + exp(-each)) for each in odds]
    expected = [two[0], (1 - two[0]) * two[1], (1 - two[0]) * (1 - two[1]) * two[2]]
    found = [exp(each) for each in number_likelihoods(steps((1, 0.25), (2, 0.125), (3, 0.125), cells=4), weights)]
    assert found == pytest.approx([*expected, 1 - sum(expected)])


@pytest.mark.parametrize(
    ("pairs", "segments", "other"),
    [
        ([(20, 0.02), (25, 0.02), (200, 0.1), (200, 0.2)], 3, 4),
        ([(20, 0.02), (25, 0.02), (14, 0.1), (500, 0.2)], 2, 3),
        ([(20, 0.02), (25, 0.02), (8, 0.1), (8, 0.2)], 1, 2),
        ([(500, 0.1), (500, 0.1)], 3, 2),
    ],
)
def test_joining_ends_before_two_textures_become_one(pairs: list[tuple[float, float]], segments: int, other: int):
    with collected() as notes:
        assert likeliest_division(steps(*pairs)).max() + 1 == segments
    [note] = notes
    assert note.startswith(f"segments: {segments}, estimated with confidence ")
    assert f"the next best number is {other}, with " in note


@pytest.mark.parametrize(("cells", "most"), [(1, 2), (287, 2), (288, 3), (1536, 16), (10**6, 16)])
def test_small_picture_has_few_textures(cells: int, most: int):
    assert largest_number(cells) == most


def test_difference_among_few_cells_counts_less():
    pairs = (20, 0.05), (40, 0.1)
    assert likeliest_division(steps(*pairs)).max() + 1 == 2
    assert likeliest_division(steps(*pairs, cells=768)).max() + 1 == 1


def test_confidence_is_the_probability_among_the_numbers_that_were_possible():
    rest = steps((25, 0.1), (60, 0.2))
    probabilities = np.exp(number_likelihoods(rest))
    assert probabilities.sum() == pytest.approx(1)
    with collected() as notes:
        likeliest_division(rest[:2])  # which never ends at one cluster
    assert f"confidence {probabilities[:2].max() / probabilities[:2].sum():.2f}" in notes[0]


def test_joining_of_unknown_distance_says_nothing():
    known = steps((60, 0.1), (20, 0.02), (200, 0.2))
    unknown = [known[0]._replace(distance=np.inf), *known[1:]]
    found = np.exp(number_likelihoods(unknown))
    assert found[0] == 0
    np.testing.assert_allclose(found[1:], np.exp(number_likelihoods(known[1:])))


def test_clusters_without_any_difference_are_one_texture():
    with collected() as notes:
        assert not likeliest_division(steps((0, 0.1), (0, 0.25))).any()
    assert notes == ["segments: 1, estimated with confidence 1.00: the next best number is 3, with 0.00"]
    with collected() as notes:
        likeliest_division(steps())
    assert notes == ["segments: 1, estimated with confidence 1.00: no two parts differ"]
