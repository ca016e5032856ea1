"""Blind comparisons: drawn fairly, counted rightly, and how likely the count is by chance alone."""

import math
from collections import Counter
from types import SimpleNamespace
from typing import Any
from unittest.mock import Mock

import numpy as np
import pytest

from tangible_ui.feeling.comparison import ComparisonLoop
from tangible_ui.feeling.feeling import Feeling
from tangible_ui.state.laws import Laws, Tally


def test_choice_counts_for_the_law_of_that_name() -> None:
    tally = Tally(("proxy", "penalty"), "Which is smoother?")
    for first, choice, chosen in ((0, 1, "proxy"), (1, 1, "penalty"), (0, 2, "penalty"), (1, 2, "proxy"), (0, 0, "")):
        tally.first = first
        assert (tally.law(1), tally.law(2)) == (first, 1 - first)
        tally.choose(choice)
        assert tally.trials[-1][2] == chosen
    assert tally.counts == (2, 2, 1)
    assert tally.trials[1] == ("penalty", "proxy", "penalty")


def test_laws_come_first_equally_often() -> None:
    tally = Tally(("a", "b"), "")
    drawn = Counter[int]()
    for _ in range(2000):
        tally.draw()
        drawn[tally.first] += 1
    assert abs(drawn[0] - 1000) < 200  # nine standard deviations


@pytest.mark.parametrize(
    ("one", "two", "neither", "chance"),
    [(0, 0, 0, 1.0), (0, 0, 9, 1.0), (1, 0, 0, 1.0), (5, 0, 0, 0.0625), (9, 1, 3, 0.021484375), (5, 5, 0, 1.0)],
)
def test_chance_is_the_sign_test(one: int, two: int, neither: int, chance: float) -> None:
    """Against tables of the binomial distribution: 2 (1 + 10) / 2^10 for nine of ten."""
    trials = [("a", "b", "a")] * one + [("a", "b", "b")] * two + [("a", "b", "")] * neither
    assert Tally(("a", "b"), "", trials).chance == chance


@pytest.mark.parametrize("running", [True, False])
def test_second_law_follows_the_hand_and_leaves_with_it(running: bool) -> None:
    ring = SimpleNamespace(latest=lambda: np.arange(17.0))
    feeling: Any = Mock(Feeling, servo=SimpleNamespace(ring=ring), running=running)
    comparison = Mock(ComparisonLoop, running=True)
    Laws(comparison).follow(feeling)
    comparison.follow.assert_called_once_with((2.0, 3.0, 4.0 if running else math.inf))


@pytest.mark.parametrize("first", [0, 1])
def test_pages_know_nothing_of_the_laws_of_a_blind_comparison(first: int) -> None:
    laws = Laws(Mock(ComparisonLoop, force_n=(0.0, 0.0, 1.0)), {"use": "proxy"}, ("penalty", "proxy"), felt=1, called=2)
    assert laws.message() == {"state": "two", "named": ["penalty", "proxy"], "felt": 1}
    laws.tally = Tally(laws.named, "Which is smoother?", [("penalty", "proxy", "proxy")], first)
    assert laws.message() == {"state": "blind", "called": 2, "trials": 1, "question": "Which is smoother?"}
    assert (laws.other_law().blind, laws.other_law().force_n) == (True, (0.0, 0.0, 0.0))
