"""Rows about several participants: means, differences and p, with Student's t in closed form for two degrees of freedom
and the binomial distribution summed."""

from math import comb, isnan, nan, sqrt
from statistics import mean, stdev

import pytest

from tangible_core.errors import TangibleError
from tangible_study.analysis.analysing import Analysis, CountedAnswers, analyse_comparison
from tangible_study.analysis.files import as_markdown, as_tsv
from tangible_study.design import Comparison, Study
from tangible_study.measures.functions import CHOICE, DISTANCE, answer_blocks
from tangible_study.measures.rows import ALL, Result, Row, What, is_sure
from tangible_study.measures.shares import count_wins
from tangible_study.statistics.intervals import Estimate, proportion
from tangible_study.trials import Answer

T_2 = 0.95 / sqrt(2 * 0.025 * 0.975)
"""Student's t that 2.5 % exceed, for two degrees of freedom: (2 q - 1) / sqrt(2 q (1 - q)) for the quantile q."""


def p_of_three(values: list[float], expected: float) -> float:
    """Return Student's two-sided p of three values: 1 - t / sqrt(t^2 + 2)."""
    t = abs(mean(values) - expected) / (stdev(values) / sqrt(3))
    return 1 - t / sqrt(t * t + 2)


def at_least(count: int, trials: int, chance: float) -> float:
    """Return the binomial probability of as many or more."""
    return sum(comb(trials, n) * chance**n * (1 - chance) ** (trials - n) for n in range(count, trials + 1))


def answer(condition: str, response: str = "1", **more) -> Answer:
    return Answer(1, "test", "c", "any", "any", condition, response=response, **more)


def hits(right: int, trials: int, **more) -> list[Answer]:
    return [answer("one", other="two", correct=int(n < right), chosen=int(n < right), **more) for n in range(trials)]


def table(result: Result) -> dict[tuple[str, str, str, str], Row]:
    rows = {(*row.what, row.participant): row for row in result.rows}
    assert len(rows) == len(result.rows)
    return rows


@pytest.mark.parametrize(
    ("right", "by_trials"),
    [((6, 7, 8), False), ((4, 4, 5), True), ((7, 7, 7), True)],
    ids=["participants", "trials", "participants who do not differ at all"],
)
def test_p_of_right_answers_is_the_greater_of_trials_and_participants(right: tuple[int, ...], by_trials: bool):
    given = {f"S0{n}": hits(each, 10) for n, each in enumerate(right)}
    rows = table(analyse_comparison(Comparison(name="c", question="same"), given))
    both = rows["proportion correct", "one", "two", ALL]
    shares = [each / 10 for each in right]
    of_trials = at_least(sum(right), 30, 1 / 3)
    expected = of_trials if by_trials else p_of_three(shares, 1 / 3)
    assert both.p == pytest.approx(expected, rel=1e-9)
    assert (both.trials, both.count, both.chance) == (30, sum(right), 1 / 3)
    half = T_2 * stdev(shares) / sqrt(3)
    exact = proportion(sum(right), 30)
    assert both.estimate == pytest.approx(
        (mean(shares), min(exact.low, mean(shares) - half), max(exact.high, mean(shares) + half))
    )
    chosen = analyse_comparison(
        Comparison(name="c", question="rougher", conditions=("one", "two")), {"S01": hits(2, 10)}
    )
    two_sided = table(chosen)["proportion chosen", "one", "two", "S01"].p
    assert two_sided == pytest.approx(2 * at_least(8, 10, 0.5)), "choices count on both sides, right answers on one"
    for name, each in zip(given, right, strict=True):
        own = rows["proportion correct", "one", "two", name]
        assert own.p == pytest.approx(at_least(each, 10, 1 / 3))
        assert own.estimate == proportion(each, 10)


def test_interval_and_difference_are_of_participants_who_can_be_compared():
    """Student's interval of 1, 1 and .5 reaches to 1.55, and that of d' below 0."""
    given = {name: hits(right, 10) for name, right in (("S01", 10), ("S02", 10), ("S03", 5))}
    rows = table(analyse_comparison(Comparison(name="c", question="same"), given))
    assert rows["proportion correct", "one", "two", ALL].estimate[1:] == pytest.approx(
        (5 / 6 - T_2 * sqrt(1 / 12) / sqrt(3), 1.0)
    )
    differ = {
        name: [answer("one", "different", other="two", target="different")] * hit
        + [answer("one", "same", other="two", target="different")] * (20 - hit)
        + [answer("one", "different", other="two", target="same")] * 2
        + [answer("one", "same", other="two", target="same")] * 18
        for name, hit in (("S01", 20), ("S02", 4), ("S03", 3))
    }
    dprime = table(analyse_comparison(Comparison(name="c", question="different"), differ))["d'", "one", "two", ALL]
    assert dprime.estimate.low == 0.0 < dprime.estimate.value < dprime.estimate.high
    assert dprime.chance == 0.0
    given = {
        "S01": [answer("one", "2"), answer("one", "4"), answer("two", "5"), answer("two", "7")],
        "S02": [answer("one", "1"), answer("two", "2"), answer("two", "4")],
        "S03": [answer("one", "3"), answer("two", "7")],
        "S04": [answer("one", "7")],
    }
    rows = table(analyse_comparison(Comparison(name="c", question="rating"), given))
    found = rows["difference of mean rating", "two", "one", ALL]
    assert found.estimate == pytest.approx((3.0, 3 - T_2 / sqrt(3), 3 + T_2 / sqrt(3)))
    assert found.p == pytest.approx(p_of_three([3.0, 2.0, 4.0], 0.0))
    assert found.trials == 5 + 5
    assert rows["mean rating", "one", "", ALL].estimate.value == pytest.approx((3 + 1 + 3 + 7) / 4)
    assert isnan(rows["mean rating", "one", "", ALL].p), "a rating has no value by chance"
    assert rows["standard deviation", "one", "", "S01"].estimate.value == pytest.approx(sqrt(2))
    assert ("standard deviation", "one", "", "S03") not in rows, "of one value"


def test_answers_are_counted_from_the_standard_by_level_or_distance():
    given = {"S01": [answer("one", each, level=0.1) for each in ("0.4", "0.5", "0.6")]}
    equal = Comparison(name="c", question="equal", levels=(0.1, 0.9), standard=0.3, unit="m")
    row = table(analyse_comparison(equal, given))["constant error", "one", "", "S01"]
    assert row.estimate == pytest.approx((0.2, 0.2 - T_2 * 0.1 / sqrt(3), 0.2 + T_2 * 0.1 / sqrt(3)))
    assert (row.unit, row.chance, row.trials) == ("m", 0.0, 3)
    assert row.p == pytest.approx(p_of_three([0.4, 0.5, 0.6], 0.3))
    some = [
        answer("one", level=level, standard=2.0, chosen=chosen, correct=correct)
        for level, chosen, correct in ((3.0, 1, 1), (1.0, 1, 0), (3.0, 0, 0), (1.0, 0, 1), (2.5, 1, 1))
    ]
    by_level, by_distance = answer_blocks(some, CHOICE), answer_blocks(some, DISTANCE)
    assert [each.tolist() for each in by_level] == [[1.0, 2.5, 3.0], [1, 1, 1], [2, 1, 2]]
    assert [each.tolist() for each in by_distance] == [[0.5, 1.0], [1, 2], [1, 4]]


def at_levels(condition: str, *counts: int) -> list[Answer]:
    """Return 20 answers at each of five levels about 2, so many of which chose the level."""
    return [
        answer(condition, level=level, standard=2.0, chosen=int(n < count), correct=int(n < count))
        for level, count in zip((1.0, 1.5, 2.0, 2.5, 3.0), counts, strict=True)
        for n in range(20)
    ]


def test_thresholds_differ_in_equality_and_may_be_guesses():
    """One curve is steep about 2, the other shallow about 2.25; the second participant answered at one level alone."""
    higher = Comparison(name="c", question="higher", levels=(1.0, 1.5, 2.0, 2.5, 3.0), standard=2.0, unit="N")
    given = {"S01": [*at_levels("one", 0, 1, 10, 19, 20), *at_levels("two", 1, 4, 8, 12, 17)]}
    given["S02"] = [at_level for at_level in at_levels("one", 0, 1, 10, 19, 20) if at_level.level == 2.0]
    result = analyse_comparison(higher, given)
    rows = table(result)
    for measure in ("point of equality", "just noticeable difference"):
        one, two = (rows[measure, name, "", "S01"].estimate for name in ("one", "two"))
        assert two.value > one.value
        apart = rows[f"difference of {measure}", "two", "one", ALL]
        assert apart.estimate.value == pytest.approx(two.value - one.value)
    assert rows["point of equality", "one", "", "S01"].estimate.value == pytest.approx(2.0, abs=0.03)
    noticed, width = (rows[each, "one", "", "S01"].estimate.value for each in ("just noticeable difference", "width"))
    assert noticed == pytest.approx(0.6744898 / 3.2897073 * width, rel=1e-5)
    assert rows["point of equality", "one", "", "S01"].chance == 2.0
    assert rows["point of equality", "one", "", "S01"].unit == rows["width", "one", "", "S01"].unit == "N"
    assert any("S02/one has answers at one level only" in note for note in result.notes)
    with pytest.raises(TangibleError, match="c: has answers at one level only; run it to the end"):
        analyse_comparison(higher, {"S02": given["S02"]})
    same = Comparison(name="c", question="same", levels=(1.0, 1.5, 2.5, 3.0), standard=2.0, unit="N")
    some = [at_level for at_level in at_levels("one", 12, 8, 0, 8, 12) if at_level.level != 2.0]
    result = analyse_comparison(same, {"S01": some})
    assert {(row.what.measure, row.unit) for row in result.rows} == {("threshold", "N"), ("width", "ln")}
    assert result.curves["S01/one"].chance == 1 / 3 and result.main == "threshold"
    (threshold,) = (row.estimate.value for row in result.rows if row.what.measure == "threshold")
    outside = not 0.5 <= threshold <= 1.0
    assert any("is outside the levels that were presented" in note for note in result.notes) is outside


@pytest.mark.parametrize(("first", "noted"), [(15, False), (16, True), (5, True), (6, False)])
def test_answers_that_favour_an_interval_are_noted(first: int, noted: bool):
    """Of 21: the exact interval of 16 reaches down to .528, and that of 15 to .478."""
    given = [answer("one", "1" if n < first else "2", other="two", chosen=n % 2) for n in range(21)]
    pair = Comparison(name="c", question="rougher", conditions=("one", "two"))
    notes = analyse_comparison(pair, {"S01": given}).notes
    assert [
        note.startswith(f"The first interval was chosen in {100 * first / 21:.0f} % of the trials") for note in notes
    ] == ([True] if noted else [])


def test_three_conditions_are_on_a_scale_with_wins_on_the_right_side():
    """By hand: two beats one in 9 of 10, three beats two in 6 of 10, and one never beats three."""
    wins = {("one", "two"): 1, ("two", "three"): 4, ("one", "three"): 0}
    given = [answer(one, other=other, chosen=int(n < won)) for (one, other), won in wins.items() for n in range(10)]
    result = analyse_comparison(
        Comparison(name="c", question="rougher", conditions=("one", "two", "three")), {"S01": given}
    )
    assert count_wins(given, ["one", "two", "three"]).tolist() == [[0, 1, 0], [9, 0, 4], [10, 6, 0]]
    rows = table(result)
    scale = [rows["scale value", each, "", "S01"].estimate.value for each in ("one", "two", "three")]
    assert scale[0] < scale[1] < scale[2] and sum(scale) == pytest.approx(0, abs=1e-9)
    assert rows["difference of scale value", "two", "one", "S01"].estimate.value == pytest.approx(scale[1] - scale[0])
    assert ("difference of scale value", "one", "two", "S01") not in rows
    assert (result.main, rows["scale value", "one", "", "S01"].trials) == ("scale value", 30)
    assert [note for note in result.notes if "half a choice" in note] == []
    assert rows["proportion chosen", "two", "three", "S01"].count == 4


@pytest.mark.parametrize(
    ("estimate", "p", "sure"),
    [
        ((0.8, 0.6, 0.9), 0.049, True),
        ((0.8, 0.6, 0.9), 0.05, False),
        ((0.8, 0.6, 0.9), nan, True),
        ((0.8, 0.5, 0.9), 0.001, False),
        ((0.2, 0.1, 0.4), 0.001, True),
        ((0.8,), 0.001, False),
    ],
)
def test_what_is_sure_is_outside_the_interval_and_below_5_percent(estimate: tuple[float, ...], p: float, sure: bool):
    assert is_sure(Row(What("m", "one", "two"), "S01", Estimate(*estimate), "", 20, 16, 0.5, p)) is sure


def test_tables_have_each_figure_in_its_column():
    """A table for a paper has the rows of all, and p of three digits; that for programs has every row."""
    rows = [
        Row(What("share", "one", "two"), "S01", Estimate(0.75, 0.5, 1.0), "", 4, 3, 0.5, 0.25),
        Row(What("share", "one", "two"), ALL, Estimate(0.7, 0.41, 0.9), "m", 8, None, 1 / 3, 0.0009),
        Row(What("share", "one", "three"), ALL, Estimate(0.25), "", 9, None, nan, 0.0496),
        Row(What("share", "two", "three"), ALL, Estimate(0.25), "", 9, None, nan, nan),
        Row(What("share", "two", "four"), ALL, Estimate(0.25), "", 9, None, nan, 0.001),
    ]
    result = Result("c", "rating", ["S01", "S02"], rows, "share")
    analysis = Analysis(CountedAnswers(Study(study="s", title="Of waves"), {}, 0, 0), [result])
    assert [line for line in as_markdown(analysis).splitlines() if line.startswith(("# ", "| share"))] == [
        "# Of waves",
        "| share | one | two | 0.7 m | 0.41 to 0.9 | 0.333 | < .001 | 8 |",
        "| share | one | three | 0.25 |  |  | .050 | 9 |",
        "| share | two | three | 0.25 |  |  |  | 9 |",
        "| share | two | four | 0.25 |  |  | .001 | 9 |",
    ]
    assert as_tsv(analysis).replace("\t", " ").splitlines()[:3] == [
        "comparison measure condition other participant value low high unit trials count chance p",
        "c share one two S01 0.75 0.5 1 n/a 4 3 0.5 0.25",
        "c share one two all 0.7 0.41 0.9 m 8 n/a 0.33333333 0.0009",
    ]
