"""Observer models and power: their answers have the shares that theory gives, and a plan keeps its promise."""

from pathlib import Path

import numpy as np
import pytest

from tangible_core.errors import ConfigError
from tangible_study.analysis.analysing import analyse_comparison
from tangible_study.analysis.sentences import is_sure
from tangible_study.simulation.observers import observer_of
from tangible_study.simulation.power import participants_needed, plan, power_of, shortened
from tangible_study.simulation.simulating import kept_of, simulate
from tangible_study.statistics.sensitivity import naming_correct, oddity_correct, two_afc
from tangible_study.study_file import StudyFile, load_study, parse_study

ROOT = Path(__file__).parents[3]
STUDY = """\
study: s
pipeline: feel.yaml
conditions: {one: {}, two: {set: {render.use: penalty}}}
comparisons:
"""
ODD = "- {name: odd, question: same, repetitions: 600}\n"
PAIR = "- {name: pair, question: higher, repetitions: 600}\n"
PARTS = "- {name: parts, question: name, conditions: [one, two], names: [a, b, c], repetitions: 200}\n"
FORCES = (
    "- {name: force, question: higher, conditions: [one], vary: render.stiffness_n_per_m, levels: [93, 100, 107], "
    "standard: 100, repetitions: 600}\n"
)


def study_of(folder: Path, comparisons: str) -> StudyFile:
    (folder / "feel.yaml").write_text("scene: builtin/brick\nwant: touch\nrender: proxy\ndevice: mock\n")
    return parse_study(STUDY + comparisons, folder / "study.yaml")


@pytest.mark.parametrize(
    ("comparisons", "model", "sets", "share"),
    [
        (ODD, "detection", ["difference=2"], oddity_correct(2.0)),
        (ODD, "hand", ["difference=0.07"], oddity_correct(0.954)),
        (ODD, "hand", ["quantity=height", "first=0.001", "difference=0.00026"], oddity_correct(2 * 0.954)),
        (PARTS, "detection", ["difference=0", "base=1"], naming_correct(1.0, 3)),
    ],
)
def test_shares_of_right_answers_are_those_of_theory(
    tmp_path: Path, comparisons: str, model: str, sets: list[str], share: float
):
    file = study_of(tmp_path, comparisons)
    answers = simulate(file, observer_of(model, [*sets, "lapse=0", "spread=0"], file), 0, 7)
    correct = [each.correct for each in answers]
    assert np.mean(correct) == pytest.approx(share, abs=3.5 * (share * (1 - share) / len(correct)) ** 0.5)


def test_psychometric_observer_has_its_threshold(tmp_path: Path):
    """By the definition of a threshold of three intervals: halfway from chance, 67 %."""
    distances = "vary: render.stiffness_n_per_m, levels: [120, 160], standard: 100"
    file = study_of(tmp_path, f"- {{name: far, question: same, conditions: [one], {distances}, repetitions: 600}}\n")
    observer = observer_of("psychometric", ["threshold=20", "lapse=0", "spread=0", "personal=0"], file)
    right = [each.correct for each in simulate(file, observer, 0, 7) if each.level == 120]
    assert np.mean(right) == pytest.approx(2 / 3, abs=0.07)


def test_a_noticeable_difference_of_force_is_noticed_in_three_of_four_trials(tmp_path: Path):
    file = study_of(tmp_path, FORCES)
    answers = simulate(file, observer_of("hand", ["lapse=0", "spread=0"], file), 0, 7)
    more = [each.chosen for each in answers if each.level == 107]
    assert np.mean(more) == pytest.approx(0.75, abs=0.06)


def test_lapses_are_answers_by_chance(tmp_path: Path):
    file = study_of(tmp_path, PAIR)
    answers = simulate(file, observer_of("detection", ["difference=30", "lapse=0.5"], file), 0, 7)
    assert np.mean([each.chosen for each in answers]) == pytest.approx(0.25, abs=0.06)
    assert two_afc(0.75) > 0


def test_same_seed_gives_the_same_answers_and_another_does_not(tmp_path: Path):
    file = study_of(tmp_path, ODD)
    observer = observer_of("detection", [], file)
    assert simulate(file, observer, 1, 3) == simulate(file, observer, 1, 3)
    assert simulate(file, observer, 1, 3) != simulate(file, observer, 1, 4)
    times = [[each.response_time for each in simulate(file, observer, number, 3)] for number in (1, 2)]
    assert times[0] != times[1], "each participant has chances of their own, not only trials of their own"


@pytest.mark.parametrize(
    ("model", "sets", "complaint"),
    [
        ("detecton", [], "did you mean 'detection'"),
        ("detection", ["diference=1"], "did you mean 'difference'"),
        ("detection", ["lapse=2"], "lapse: Input should be less than or equal to 0.5"),
        ("psychometric", [], "odd: has no levels"),
    ],
)
def test_mistakes_about_observers_are_named(tmp_path: Path, model: str, sets: list[str], complaint: str):
    with pytest.raises(ConfigError, match=complaint):
        observer_of(model, sets, study_of(tmp_path, ODD))


def test_power_is_that_of_the_tables():
    """Cohen, Statistical Power Analysis (1988): d = 0.5 needs 34, d = 0.8 needs 15, for a power of 0.8."""
    assert [min(n for n in range(2, 60) if power_of(d, 1.0, n) >= 0.8) for d in (0.5, 0.8)] == [34, 15]
    assert power_of(0.0, 1.0, 20) == pytest.approx(0.05)
    assert participants_needed([-1.0, 1.0] * 50, 0.8) is None


def test_a_planned_study_finds_the_difference_about_as_often_as_promised(tmp_path: Path):
    """Nothing is assumed here: whole studies of the planned size are simulated, and their sentences counted."""
    file = study_of(tmp_path, ODD.replace("600", "12"))
    observer = observer_of("detection", ["difference=1.6"], file)
    need = next(each for each in plan(file, observer) if each.repetitions == 12)
    assert need.participants is not None
    one = shortened(file, file.study.comparisons[0], 12)
    [odd] = one.study.comparisons
    found = 0
    for study in range(60):
        kept = kept_of(one, [simulate(one, observer, number, 1000 + study) for number in range(need.participants)])
        [row] = analyse_comparison(odd, kept.of(odd)).of_all("proportion correct")
        found += is_sure(row)
    assert 0.6 <= found / 60 <= 0.97
    [nothing, *_] = plan(file, observer_of("detection", ["difference=0"], file))
    assert nothing.participants is None


@pytest.mark.parametrize("name", ["force-laws", "recognition"])
def test_examples_can_be_planned(name: str):
    file = load_study(ROOT / f"configs/studies/{name}.yaml")
    answers = simulate(file, observer_of("detection", ["difference=2", "spread=0"], file), 0, 1)
    assert 40 <= len(answers) <= 80  # half an hour
    assert file.study.consent
    assert set(file.study.comparisons[0].names) <= {"door", "front wheel", "seat", "tank", "engine"}
