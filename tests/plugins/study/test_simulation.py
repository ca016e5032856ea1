"""Simulated participants, and experiments that go wrong: a study would promise figures that it cannot find."""

from math import inf
from pathlib import Path
from statistics import NormalDist

import numpy as np
import pytest

from tangible_core.errors import ConfigError
from tangible_study.analysis.analysing import analyse_comparison, sentences
from tangible_study.design import Comparison
from tangible_study.measures.rows import ALL, Result, Row, What
from tangible_study.procedures import Stimulus, Trial
from tangible_study.simulation.observers import Detection, Hand, Psychometric, make_observer
from tangible_study.simulation.power import (
    count_answers,
    participant_effects,
    participants_needed,
    power_by_t_test,
    simulate,
)
from tangible_study.statistics.intervals import Estimate
from tangible_study.statistics.psychometric import Blocks, fit_choice, fit_difference
from tangible_study.statistics.sensitivity import naming_correct, oddity_correct
from tangible_study.study_file import StudyFile, load_study, parse_study
from tangible_study.trials import Answer

ROOT = Path(__file__).parents[3]
STUDY = """\
study: s
pipeline: feel.yaml
conditions: {one: {}, two: {set: {render.use: penalty}}}
comparisons:
"""
ODD = "- {name: odd, question: same, repetitions: 600}\n"
PARTS = "- {name: parts, question: name, conditions: [one, two], names: [a, b, c], repetitions: 200}\n"


def study_of(folder: Path, comparisons: str) -> StudyFile:
    (folder / "feel.yaml").write_text("scene: builtin/brick\nwant: touch\nrender: proxy\ndevice: mock\n")
    return parse_study(STUDY + comparisons, folder / "study.yaml")


@pytest.mark.parametrize(
    ("comparison", "model", "sets", "share"),
    [
        (ODD, "detection", ["difference=2"], oddity_correct(2.0)),
        (ODD, "hand", ["quantity=height", "first=0.001", "difference=0.00026"], oddity_correct(2 * 0.954)),
        (PARTS, "detection", ["difference=0", "base=1"], naming_correct(1.0, 3)),
    ],
)
def test_shares_of_right_answers_are_those_of_theory(
    tmp_path: Path, comparison: str, model: str, sets: list[str], share: float
):
    file = study_of(tmp_path, comparison)
    answers = simulate(file, make_observer(model, [*sets, "lapse=0", "spread=0"], file), 0, 7)
    correct = [answer.correct for answer in answers]
    assert np.mean(correct) == pytest.approx(share, abs=3.5 * (share * (1 - share) / len(correct)) ** 0.5)
    kept = count_answers(file, [answers, answers])
    assert (kept.trials, kept.training, list(kept.by_participant)) == (2 * len(answers), 0, ["S01", "S02"])


def test_seed_decides_the_answers_and_mistakes_are_named(tmp_path: Path):
    file = study_of(tmp_path, ODD)
    observer = make_observer("detection", [], file)
    assert simulate(file, observer, 1, 3) == simulate(file, observer, 1, 3)
    assert simulate(file, observer, 1, 3) != simulate(file, observer, 1, 4)
    times = [[each.response_time for each in simulate(file, observer, number, 3)] for number in (1, 2)]
    assert times[0] != times[1], "each participant has chances of their own, not only trials of their own"
    for model, sets, named in (
        ("detecton", [], "detection"), ("hand", ["jdn=1"], "jnd"), ("hand", ["lapse=2"], "lapse"),
        ("psychometric", [], "odd"),
    ):  # fmt: skip
        with pytest.raises(ConfigError, match=named):
            make_observer(model, sets, study_of(tmp_path, ODD))


@pytest.mark.parametrize("name", ["force-laws", "recognition"])
def test_examples_can_be_planned(name: str):
    file = load_study(ROOT / f"configs/studies/{name}.yaml")
    answers = simulate(file, make_observer("detection", ["difference=2", "spread=0"], file), 0, 1)
    assert 40 <= len(answers) <= 80  # half an hour
    assert file.study.consent
    assert set(file.study.comparisons[0].names) <= {"door", "front wheel", "seat", "tank", "engine"}


class Still(np.random.Generator):
    """A source of chance without noise; its draws are given."""

    def __init__(self, *drawn: float) -> None:
        super().__init__(np.random.PCG64(0))
        self.drawn = list(drawn)

    def standard_normal(self, size: int | None = None) -> float | np.ndarray:
        return 0.0 if size is None else np.zeros(size)

    def normal(self, middle: float, spread: float) -> float:
        return middle + self.drawn.pop(0) * spread

    def random(self) -> float:
        return self.drawn.pop(0)

    def choice(self, choices: list[str]) -> str:
        return choices[-1]


LEVELS = (1.0, 2.0, 3.0, 4.0)


def trial(question: str, *intervals: Stimulus, given: str = "12", **more) -> Trial:
    choices = tuple(map(repr, LEVELS)) if question == "equal" else tuple(given)
    return Trial("c", question, "any", intervals, choices, intervals[-1].condition, **more)


def compared(question: str, **more) -> Comparison:
    return Comparison(name="c", question=question, conditions=("one", "two", "three"), **more)


@pytest.mark.parametrize(
    ("asked", "answer"),
    [
        (trial("rougher", Stimulus("two"), Stimulus("one")), "1"),
        (trial("rougher", Stimulus("one"), Stimulus("three")), "2"),
        (trial("same", Stimulus("one"), Stimulus("three"), Stimulus("one"), given="123"), "2"),
        (trial("same", Stimulus("three"), Stimulus("three"), Stimulus("two"), given="123"), "3"),
        (trial("different", Stimulus("one"), Stimulus("two")), "same"),  # 1 is less than the criterion
        (trial("different", Stimulus("three"), Stimulus("one")), "different"),
        (trial("name", Stimulus("one"), given="abc", target="b"), "b"),
        (trial("rating", Stimulus("one"), given="12345"), "3"),
        (trial("rating", Stimulus("two"), given="12345"), "4"),
        (trial("rating", Stimulus("three"), given="1234"), "4"),
        (trial("equal", Stimulus("one", 2.6), Stimulus("one", 1.0)), "3.0"),
        (trial("equal", Stimulus("one", 2.4), Stimulus("one", 4.0)), "2.0"),
    ],
)
def test_observer_without_noise_answers_by_what_differs(asked: Trial, answer: str):
    observer = Detection(difference=1.0, lapse=0.0)
    levels = LEVELS if asked.question == "equal" else ()
    assert observer.answer(asked, compared(asked.question, levels=levels), Still(0.5)) == answer
    lapses = [
        Detection(lapse=0.02).answer(asked, compared(asked.question, levels=levels), Still(drawn))
        for drawn in (0.0199,)
    ]
    assert lapses == [asked.choices[-1]], "any of the choices"


def test_observers_answer_by_their_function_and_feel_differences():
    """By draws just below and above its share: a cumulative Gaussian, and a Weibull function from 1/3 on."""
    gaussian = NormalDist(2.5 + 0.4, 1.2 / 3.28970725)
    plain = Psychometric(lapse=0.0, width=1.2, difference=0.4)

    def respond(question: str, given: str, draw: float, condition: str = "two", level: float = 1.0, position: int = 1):
        asked = trial(question, Stimulus(condition), given=given, level=level, standard=2.5, position=position)
        return plain.respond(asked, compared(question, levels=LEVELS, standard=2.5), Still(draw))

    for level in LEVELS:
        middle = gaussian.cdf(level)
        for position in (1, 2):
            told = [respond("higher", "12", middle + off, level=level, position=position) for off in (-1e-9, 1e-9)]
            assert told == [str(position), str(3 - position)]
        share = 1 / 3 + 2 / 3 * (1 - 2 ** -((abs(level - 2.5) / (0.75 + 0.4)) ** 2.0))
        assert [respond("same", "123", share + off, level=level) for off in (-1e-9, 1e-9)] == ["1", "3"]
    told = [respond("equal", "", draw, name) for name in ("one", "three") for draw in (-2.0, 0.5)]
    assert told == ["2.0", "3.0", "3.0", "3.0"]
    noticed = NormalDist().inv_cdf(0.75) * 2**0.5
    for quantity, levels, apart in (
        ("force", (0.5, 1.0, 1.07), [np.log(0.5) / np.log(1.07) * noticed, 0.0, noticed]),
        ("height", (0.5, 1.0, 1.00013), [-0.5 / 0.00013 * noticed, 0.0, noticed]),
    ):
        hand = Hand(quantity=quantity, lapse=0.0)
        for level, expected in zip(levels, apart, strict=True):
            for just in (-1e-6 - 1e-3 * abs(expected), 1e-6 + 1e-3 * abs(expected)):

                class Noisy(Still):
                    def standard_normal(self, size=None, by=(expected + just)):
                        return np.array([0.0, by])

                asked = trial("higher", Stimulus("one", level), Stimulus("one", 1.0))
                told = hand.respond(asked, compared("higher", levels=levels, standard=1.0), Noisy())
                assert told == ("2" if just > 0 else "1")

    def row(measure: str, name: str, value: float, condition: str, other: str = "", chance: float = np.nan) -> Row:
        return Row(What(measure, condition, other), name, Estimate(value), "", 10, None, chance)

    ratings = {"S01": {"one": 3.0, "two": 5.0, "three": 4.0}, "S02": {"one": 2.0, "two": 5.0}, "all": {"one": 9.0}}
    single = [
        row("mean rating", name, value, condition) for name, of in ratings.items() for condition, value in of.items()
    ]
    rated = Result("c", "rating", ["S01", "S02"], single, "mean rating")
    assert participant_effects(rated) == {("two", "one"): [2.0, 3.0], ("three", "one"): [1.0], ("three", "two"): [-1.0]}
    odd = [row("proportion correct", name, share, "one", "two", 1 / 3) for name, share in (("S01", 0.5), ("S02", 0.25))]
    found = participant_effects(Result("c", "same", ["S01", "S02"], odd, "proportion correct"))
    assert found == {("one", "two"): pytest.approx([1 / 6, -1 / 12])}
    chosen = [row("proportion chosen", "S01", 0.8, "one", "two", 0.5), row("scale value", "all", 0.3, "one")]
    assert participant_effects(Result("c", "rougher", ["S01"], chosen, "scale value")) == {
        ("one", "two"): pytest.approx([0.3])
    }


@pytest.mark.parametrize(("apart", "participants"), [(0.2, 199), (0.5, 34), (0.8, 15), (1.2, 8), (0.19, None)])
def test_participants_needed_are_those_of_cohen_s_tables(apart: float, participants: int | None):
    """For one sample, two-sided at 5 %, power .80: Cohen (1988) and G*Power 3.1."""
    assert participants_needed([apart - 1.0, apart + 1.0] * 50_000, 0.8) == participants
    assert participants_needed([-apart - 1.0, 1.0 - apart] * 50_000, 0.8) == participants
    assert participants_needed([-0.1, 0.1], 0.8) is None
    assert power_by_t_test(0.0, 1.0, 20) == pytest.approx(0.05)
    assert power_by_t_test(0.0, 0.0, 9) == 0.0 < power_by_t_test(0.1, 0.0, 2) == 1.0


LEVELS_M = np.array([0.001, 0.0015, 0.002, 0.0025, 0.003])
HIGHER = Comparison(name="c", question="higher", levels=tuple(LEVELS_M.tolist()), standard=0.002, unit="m")
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
        for level, count in zip(LEVELS_M.tolist(), counts, strict=True)
        for n in range(trials)
    ]


def make_rows(result: Result, whom: str, condition: str = "one") -> dict[str, Row]:
    return {row.what.measure: row for row in result.rows if (row.participant, row.what.condition) == (whom, condition)}


@pytest.mark.parametrize(("counts", "trials"), EXPERIMENTS.values(), ids=EXPERIMENTS)
def test_estimates_of_an_odd_experiment_are_inside_their_intervals(counts: tuple[int, ...], trials: int):
    blocks = Blocks(LEVELS_M, np.array(counts, float), np.full(5, float(trials)))
    choice, odd = fit_choice(blocks, (0.001, 0.003)), fit_difference(blocks, (0.001, 0.003))
    for estimate in (choice.threshold, choice.width, odd.threshold, odd.width):
        assert estimate.low <= estimate.value <= estimate.high


def test_answers_without_both_kinds_leave_bounds_alone():
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
    all_right, none = (
        fit_difference(Blocks(LEVELS_M, np.full(5, n), np.full(5, 20.0)), (0.001, 0.003)) for n in (20.0, 0.0)
    )
    assert all_right.threshold[:2] == (0.0, 0.0) and 0 < all_right.threshold.high < 0.0015
    assert none.threshold[::2] == (inf, inf) and none.threshold.low > 0.0025
    assert all_right.at(LEVELS_M) == pytest.approx([1 - all_right.lapses] * 5)
