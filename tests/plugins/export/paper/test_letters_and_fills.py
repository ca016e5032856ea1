"""Letters and fills of parts: if a case fails, two parts feel like one."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial import Delaunay

from tangible_export.paper.colouring import choose_fills
from tangible_export.paper.fills import KINDS
from tangible_export.paper.named_parts import LETTERS, MAX_NAMES, key_letters

NAMES = st.lists(st.text("abcxyz éü7Ж", max_size=6), max_size=MAX_NAMES)


@given(NAMES)
def test_key_letters_are_different_for_all_names(names):
    letters = key_letters(names)
    assert len(letters) == len(set(letters)) == len(names)
    assert {len(letter) for letter in letters} <= {1 if len(names) <= 26 else 2}
    assert all(set(letter) <= set(LETTERS) for letter in letters)


def test_key_letter_is_the_first_free_letter_of_the_name():
    assert key_letters(["table", "spoon", "saucer", "Übung"]) == ["t", "s", "c", "u"]
    assert key_letters(["apple", "bear"]) == ["p", "b"]  # a finger takes a single dot for a stray one
    assert key_letters(["spoon", "sun", "under"]) == ["s", "n", "u"]


@given(st.integers(0, 1000), st.integers(4, 60))
def test_fills_of_planar_neighbours_differ(seed, count):
    places = np.random.default_rng(seed).random((count, 2))
    start, around = Delaunay(places).vertex_neighbor_vertices
    beside = [set(around[start[n] : start[n + 1]].tolist()) for n in range(count)]
    kinds, alike = choose_fills(beside, [list(KINDS)] * count, places[:, 0].tolist())
    assert not alike
    assert all(kinds[one] != kinds[other] for one in range(count) for other in beside[one])


def test_fills_of_few_parts_all_differ_and_largest_is_blank():
    kinds, _ = choose_fills([set()] * 5, [list(KINDS)] * 5, [1, 2, 9, 4, 5])
    assert (len(set(kinds)), kinds[2]) == (5, "blank")


def test_fills_without_room_are_blank_and_neighbours_are_filled():
    kinds, alike = choose_fills([{1}, {0, 2}, {1}], [list(KINDS), ["blank"], ["blank"]], [9, 1, 1])
    assert kinds[0] != "blank"
    assert kinds[1:] == ["blank", "blank"]
    assert not alike  # neither has another


def test_fills_that_cannot_differ_leave_the_others_different():
    """Six that all touch each other, of which two must be alike, and two more beside some of them."""
    beside = [set(range(6)) - {n} for n in range(6)] + [{0, 2, 4}, {2, 3, 4}]
    for number in (6, 7):
        for other in beside[number]:
            beside[other].add(number)
    _, alike = choose_fills(beside, [list(KINDS)] * 8, [1.0] * 8)
    assert len(alike) == 1
