"""Experiments that go wrong: all chosen, none, few trials, a step, reversed, guessing, participants who differ much."""

from math import inf

import numpy as np
import pytest

from tangible_study.analysis.analysing import analyse_comparison, sentences
from tangible_study.design import Comparison
from tangible_study.measures.rows import ALL, Result, Row
from tangible_study.statistics.psychometric import Blocks, fit_choice, fit_difference
from tangible_study.trials import Answer

LEVELS = np.array([0.001, 0.0015, 0.002, 0.0025, 0.003])
HIGHER = Comparison(name="c", question="higher", levels=tuple(LEVELS.tolist()), standard=0.002, unit="m")
EXPERIMENTS = {
    "all chosen": ((20, 20, 20, 20, 20), 20),
    "none chosen": ((0, 0, 0, 0, 0), 20),
    "all chosen once": ((1, 1, 1, 1, 1), 1),
    "a step": ((0, 0, 0, 20, 20), 20),
    "reversed": ((20, 18, 10, 2, 0), 20),
    "guessing": ((11, 9, 10, 8, 11), 20),
    "nearly all chosen": ((17, 20, 19, 20, 20), 20),
    "few trials": ((0, 1, 0, 2, 2), 2),
}


def answers(counts: tuple[int, ...], trials: int, condition: str = "one") -> list[Answer]:
    return [
        Answer(
            1, "test", "c", "any", "any", condition, level=level, response="1", standard=0.002, chosen=int(n < count)
        )
        for level, count in zip(LEVELS.tolist(), counts, strict=True)
        for n in range(trials)
    ]


def make_rows(result: Result, whom: str, condition: str = "one") -> dict[str, Row]:
    return {row.what.measure: row for row in result.rows if (row.participant, row.what.condition) == (whom, condition)}


@pytest.mark.parametrize(("counts", "trials"), EXPERIMENTS.values(), ids=EXPERIMENTS)
def test_estimates_of_an_odd_experiment_are_inside_their_intervals(counts: tuple[int, ...], trials: int):
    blocks = Blocks(LEVELS, np.array(counts, float), np.full(5, float(trials)))
    choice, odd = fit_choice(blocks, (0.001, 0.003)), fit_difference(blocks, (0.001, 0.003))
    for estimate in (choice.threshold, choice.width, odd.threshold, odd.width):
        assert estimate.low <= estimate.value <= estimate.high


def test_where_all_or_none_is_chosen_there_is_a_bound_and_no_point_of_equality():
    """A threshold at the second level would have half of these unchosen, 10 of 20; one below all levels none."""
    result = analyse_comparison(HIGHER, {"S01": answers((20,) * 5, 20), "S02": answers((0,) * 5, 20)})
    below, above = (make_rows(result, whom)["point of equality"].estimate for whom in ("S01", "S02"))
    assert below[:2] == (-inf, -inf) and below.high < 0.0015
    assert above[::2] == (inf, inf) and above.low > 0.0025
    assert make_rows(result, ALL)["point of equality"].estimate[1:] == (-inf, inf)
    assert "With one, the answers do not tell the point of equality: any level explains them." in sentences(result)
    alone = analyse_comparison(HIGHER, {"S01": answers((20,) * 5, 20)})
    assert sentences(alone)[0] == (
        f"With one, what feels equal to the standard, 0.002 m, is below {below.high:.3g} m (95 %)."
    )
    assert not any("is noticed" in sentence or "it is a guess" in sentence for sentence in sentences(alone))


def test_right_answers_alone_leave_an_upper_bound_of_the_threshold():
    all_right, none = (
        fit_difference(Blocks(LEVELS, np.full(5, n), np.full(5, 20.0)), (0.001, 0.003)) for n in (20.0, 0.0)
    )
    assert all_right.threshold[:2] == (0.0, 0.0) and 0 < all_right.threshold.high < 0.0015
    assert none.threshold[::2] == (inf, inf) and none.threshold.low > 0.0025
    assert all_right.at(LEVELS) == pytest.approx([1 - all_right.lapses] * 5)
