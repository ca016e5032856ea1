import numpy as np
from acme_staircase.staircase import Staircase

from tangible_study.design import Comparison

HEIGHTS = Comparison(
    name="h", question="higher", conditions=("a",), vary="k", levels=(2.0, 3.0, 4.0), standard=1.0, repetitions=30
)


def levels(right: list[bool], in_a_row: int = 2) -> list[float]:
    course, seen = Staircase(in_a_row=in_a_row).course(HEIGHTS, np.random.default_rng(1)), []
    for each in right:
        trial = course.next()
        assert trial is not None and trial.position is not None
        seen.append(trial.level)
        course.take(trial, str(trial.position if each else 3 - trial.position))
    return seen


def test_two_right_answers_go_down_and_a_wrong_one_up():
    assert levels([True, True, True, False, True, True, True, True]) == [4.0, 4.0, 3.0, 3.0, 4.0, 4.0, 3.0, 3.0]


def test_steps_stay_within_the_levels():
    assert levels([False] * 3) == [4.0] * 3
    assert levels([True] * 6, in_a_row=1) == [4.0, 3.0, 2.0, 2.0, 2.0, 2.0]


def test_it_ends_after_its_trials():
    assert len(levels([True] * 30)) == 30
    assert "`levels:` above it" in Staircase().refusal(HEIGHTS.model_copy(update={"standard": 2.0}))
