"""The sentences of a result, from rows whose figures are given: which condition, which side, which unit."""

from math import nan

import pytest

from tangible_study.analysis.analysing import sentences
from tangible_study.measures.rows import Result, Row, What
from tangible_study.statistics.intervals import Estimate

FEW = "The result is about 1 participant, and says little about other people."


def row(measure: str, one: str, estimate: tuple[float, ...], other: str = "", unit: str = "m", **more: float) -> Row:
    return Row(What(measure, one, other), "S01", Estimate(*estimate), unit, 20, None, **{"chance": 0.002, **more})


def text_of(question: str, main: str, *rows: Row) -> list[str]:
    *found, few = sentences(Result("c", question, ["S01"], rows, main))
    assert few == FEW
    return found


def test_equal_level_and_noticed_difference_are_those_of_one_condition():
    found = text_of(
        "higher",
        "point of equality",
        row("point of equality", "one", (0.0024, 0.0021, 0.0027)),
        row("point of equality", "two", (0.0016, 0.0013, 0.0019)),
        row("just noticeable difference", "one", (0.0003,)),
        row("just noticeable difference", "two", (0.0005,)),
    )
    equal = "feels equal to the standard, 0.002 m"
    noticed = "is noticed in three of four trials."
    assert found == [
        f"With one, 0.0024 m {equal} (95 % interval 0.0021 to 0.0027).",
        f"A difference of 0.0003 m {noticed}",
        f"With two, 0.0016 m {equal} (95 % interval 0.0013 to 0.0019).",
        f"A difference of 0.0005 m {noticed}",
    ]


@pytest.mark.parametrize(("error_m", "side"), [(0.0004, "above"), (-0.0004, "below")])
def test_constant_error_lies_on_its_side_of_the_standard(error_m: float, side: str):
    assert text_of("equal", "constant error", row("constant error", "one", (error_m,))) == [
        f"With one, 1 participant went 0.0004 m {side} the standard on average (no interval from one value)."
    ]


@pytest.mark.parametrize(
    ("share", "more", "less", "sure"),
    [
        ((0.9, 0.7, 0.99), "one", "two", True),
        ((0.2, 0.1, 0.4), "two", "one", True),
        ((0.6, 0.4, 0.8), "one", "two", False),
    ],
)  # fmt: skip
def test_condition_that_was_chosen_more_often_is_more(share: tuple[float, ...], more: str, less: str, sure: bool):
    (found,) = text_of("rougher", "proportion chosen", row("proportion chosen", "one", share, "two", chance=0.5))
    claim = f"{more} is rougher than {less}"
    value, low, high = (f"{100 * each:.0f}" for each in share)
    chose = f"1 participant chose one in {value} % of 20 trials (95 % interval {low} to {high} %)"
    if sure:
        assert found == f"{claim}: {chose}; no difference gives 50 %."
    else:
        assert found == f"It is open whether {claim}: {chose}, and no difference gives 50 %."


@pytest.mark.parametrize(
    ("estimate", "p", "sentence"),
    [
        ((3.0, 1.0, 5.0), nan, "With two, the rating is 3 greater than with one (95 % interval 1 to 5)."),
        ((-3.0, -5.0, -1.0), nan, "With two, the rating is 3 smaller than with one (95 % interval 1 to 5)."),
        ((-1.0, -3.0, 1.0), nan, "It is open whether the rating differs: with two, it is 1 smaller than with one "
         "(95 % interval -1 to 3, which holds 0)."),
        ((3.0, 1.0, 5.0), 0.2, "It is open whether the rating differs: with two, it is 3 greater than with one "
         "(95 % interval 1 to 5, which holds 0)."),
        ((2.0,), nan, "With two, the rating is 2 greater than with one; one value each does not tell how sure that "
         "is."),
    ],
)  # fmt: skip
def test_difference_has_its_direction_and_a_rising_interval(estimate: tuple[float, ...], p: float, sentence: str):
    difference = row("difference of mean rating", "two", estimate, "one", "", chance=0.0, p=p)
    assert text_of("rating", "mean rating", difference) == [sentence]


def test_probability_below_5_percent_is_a_count_of_studies_and_three_differences_show_one_by_chance():
    for p, studies in ((0.04, "about 1 of 20"), (0.003, "about 1 of 300"), (0.05, None)):
        sure = row("difference of mean rating", "two", (3.0, 1.0, 5.0), "one", chance=0.0, p=p)
        expected = f"If there were no difference, a result as clear as this would come about in {studies} studies."
        assert text_of("rating", "mean rating", sure)[1:] == ([] if studies is None else [expected])
    expected = "3 differences were looked for: if there were none, about one in 20 would seem to be there."
    for count in (2, 3):
        rows = [row("difference of mean rating", f"{each}", (2.0,), "one") for each in range(count)]
        assert text_of("rating", "mean rating", *rows)[count:] == [expected] * (count == 3)
