"""Heights guessed from size, place and border ownership."""

import numpy as np
import pytest
from scipy.stats import spearmanr

from drawn_parts import drawn
from tangible_core.data import PartMap, SegmentMap
from tangible_core.parts import find_parts, guess_heights
from tangible_core.parts.neighbours import in_front, neighbours
from tangible_core.scene.scene import Scene


def parts_of(labels) -> PartMap:
    return find_parts(SegmentMap(np.asarray(labels, np.int32)))


def discs(*centres: tuple[int, int], shape: tuple[int, int] = (200, 300), radius: int = 40) -> np.ndarray:
    """Return labels of discs at [x, y] on a ground, each over the earlier ones."""
    row, column = np.indices(shape)
    labels = np.zeros(shape, np.int32)
    for number, (x, y) in enumerate(centres, 1):
        labels[(column - x) ** 2 + (row - y) ** 2 < radius**2] = number
    return labels


def guess(labels: np.ndarray) -> dict[int, float]:
    """Guess heights by label."""
    parts = parts_of(labels)
    return dict(zip(parts.segments, guess_heights(parts, 0.004).heights_m, strict=True))


def sure_of(labels: np.ndarray) -> dict[tuple[int, int], float]:
    """Return the certainty, by pair of labels, that the second is in front."""
    parts = parts_of(labels)
    beside = neighbours(parts)
    of = np.asarray(parts.segments)
    pairs = zip(of[beside.low].tolist(), of[beside.high].tolist(), in_front(parts, beside).tolist(), strict=True)
    return {tuple(sorted((low, high))): sure if low < high else -sure for low, high, sure in pairs}


def test_neighbours_are_listed_with_the_lengths_of_their_borders():
    pairs = neighbours(parts_of([[0, 0, 1], [0, 2, 1], [3, 3, 3]]))
    assert list(zip(*(each.tolist() for each in pairs), strict=True)) == [
        (0, 1, 1), (0, 2, 2), (0, 3, 1), (1, 2, 1), (1, 3, 1), (2, 3, 1),
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("first", "second"), [((120, 100), (170, 100)), ((170, 90), (120, 110)), ((150, 130), (150, 80))]
)
def test_disc_whose_border_runs_on_is_in_front(first, second):
    labels = discs(first, second)
    assert sure_of(labels)[1, 2] > 0.4
    heights_m = guess(labels)
    assert heights_m[0] < heights_m[1] < heights_m[2]


def test_symmetric_junctions_decide_nothing():
    """Judge three parts that meet at equal angles, and four that meet in a cross."""
    row, column = np.indices((120, 120)) - 59.5
    thirds = ((np.arctan2(row, column) + np.pi) / (2 * np.pi / 3)).astype(int)
    assert max(map(abs, sure_of(thirds).values())) < 0.2
    assert not any(sure_of((row > 0) + 2 * (column > 0)).values())


def test_low_part_is_near_and_part_at_the_rims_is_far():
    labels = np.zeros((120, 160), np.int32)
    labels[90:110, 20:60] = 1
    labels[20:40, 80:120] = 2
    heights_m = guess(labels)
    assert heights_m[0] == 0
    assert heights_m[2] < heights_m[1] == 0.004


def test_enclosed_part_is_in_front():
    labels = discs((150, 100), radius=60)
    labels[60:75, 140:160] = 2
    heights_m = guess(labels)
    assert heights_m[0] < heights_m[1] < heights_m[2]


@pytest.mark.parametrize(("inside", "order"), [([60, 90, 160], (0, 2, 1)), ([220, 40, 30], (0, 1, 2))])
def test_enclosed_part_of_the_colour_beyond_is_a_hole(inside, order):
    """A dark ring low in the picture on blue; its middle is blue too, or red as a thing on a plate."""
    labels = discs((150, 140), radius=50)
    labels[discs((150, 150), radius=25) == 1] = 2
    picture = np.uint8([[70, 95, 150], [50, 40, 30], inside])[labels]
    parts = parts_of(labels)
    heights = guess_heights(parts, 0.004, picture)
    by_label = dict(zip(parts.segments, heights.heights_m, strict=True))
    assert sorted(by_label, key=by_label.__getitem__) == [order.index(rank) for rank in range(3)]
    assert ("it is behind part 2" in heights.reasons[2]) == (order == (0, 2, 1))
    assert dict(zip(parts.segments, guess_heights(parts, 0.004).heights_m, strict=True))[2] == 0.004


def test_two_parts_that_one_encloses_are_not_holes_in_it():
    labels = discs((80, 100), (220, 100))
    picture = np.uint8([[150, 180, 230], [30, 30, 30], [32, 30, 30]])[labels]
    parts = parts_of(labels)
    heights_m = guess_heights(parts, 0.004, picture).heights_m
    assert heights_m[0] == 0 < min(heights_m[1:])


def test_guess_does_not_depend_on_the_resolution():
    few = guess_heights(drawn("coffee").parts, 0.004)
    labels = drawn("coffee").parts.labels.repeat(2, axis=0).repeat(2, axis=1)  # large enough to be reduced again
    assert guess_heights(parts_of(labels), 0.004) == few


def test_specks_take_no_height_step():
    labels = discs((120, 100), (170, 100))
    with_specks = labels.copy()
    with_specks[::20, ::20] = 3
    plain, speckled = guess(labels), guess(with_specks)
    assert {label: speckled[label] for label in plain} == pytest.approx(plain)


@pytest.mark.parametrize("shape", [(1, 1), (1, 7), (7, 1), (300, 2)])
def test_guess_of_a_single_part_is_zero(shape):
    assert guess_heights(parts_of(np.zeros(shape)), 0.004).heights_m == (0,)


def test_guess_takes_a_part_for_every_pixel():
    heights = guess_heights(parts_of(np.arange(30 * 40).reshape(30, 40)), 0.004)
    assert len(heights.heights_m) == len(heights.reasons) == 1200
    assert (min(heights.heights_m), max(heights.heights_m)) == (0, 0.004)


def test_reasons_name_the_place_of_a_part_and_what_it_hides():
    heights = guess_heights(parts_of(discs((120, 100), (170, 100))), 0.004)
    assert heights.reasons == (
        "guessed, 1 of 3 from the back: it reaches down to 96 % of the picture's height and has 100 % of its upper and "
        "side rims; it is behind part 3",
        "guessed, 2 of 3 from the back: it reaches down to 68 % of the picture's height and has 0 % of its upper and "
        "side rims; it is behind part 3",
        "guessed, 3 of 3 from the back: it reaches down to 66 % of the picture's height and has 0 % of its upper and "
        "side rims; it is in front of parts 1 and 2",
    )


@pytest.mark.parametrize(("name", "least"), [("astronaut", 0.8), ("coffee", 0.8)])
def test_guess_is_near_the_heights_that_a_person_gave(name, least):
    _, parts, _, heights_m = drawn(name)
    guess = np.float32(guess_heights(parts, 0.004).heights_m)[parts.labels]
    assert spearmanr(guess.ravel(), np.float32(heights_m)[parts.labels].ravel())[0] > least


def test_guess_has_about_the_order_of_true_depth():
    parts, truth = drawn("motorcycle").parts, Scene.builtin("motorcycle").truth
    assert truth is not None
    guess = np.float32(guess_heights(parts, 0.004).heights_m)[parts.labels]
    known = np.isfinite(truth)
    assert spearmanr(guess[known], truth[known])[0] > 0.68
