"""Procedures: what they present is balanced, and follows from the file, the seed and the answers alone."""

from collections import Counter
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from tangible_core.errors import ResultsError
from tangible_study.procedures import Stimulus, Trial, score
from tangible_study.procedures.listed import Adjustment
from tangible_study.session.order import StudyCourse, comparison_order, latin_square, replay
from tangible_study.study_file import StudyFile, parse_study
from tangible_study.trials import Answer

LEVELS = "vary: workspace.relief_m, levels: [0.001, 0.0015, 0.002, 0.0025, 0.003], standard: 0.002"
STUDY = f"""\
study: s
pipeline: feel.yaml
seed: 4
conditions: {{one: {{}}, two: {{set: {{render.use: penalty}}}}}}
comparisons:
- {{name: odd, question: same, repetitions: 12, training: 3}}
- {{name: pair, question: rougher, repetitions: 4}}
- {{name: levels, question: higher, procedure: constant, conditions: [one], {LEVELS}, repetitions: 4}}
- {{name: quest, question: higher, procedure: quest, {LEVELS}, repetitions: 8}}
- {{name: equal, question: equal, {LEVELS}, repetitions: 2}}
- {{name: rate, question: rating, repetitions: 2}}
- {{name: differ, question: different, repetitions: 8, training: 2}}
- {{name: parts, question: name, names: [cup, plate, knife], repetitions: 4}}
"""


@pytest.fixture
def file(tmp_path: Path) -> StudyFile:
    (tmp_path / "feel.yaml").write_text("scene: builtin/brick\nwant: touch\nrender: proxy\ndevice: mock\n")
    return parse_study(STUDY, tmp_path / "study.yaml")


def as_answer(number: int, trial: Trial, response: str) -> Answer:
    same = ("phase", "comparison", "question", "procedure", "condition", "other", "level", "standard", "position")
    return Answer(number, **{name: getattr(trial, name) for name in same}, response=response, target=trial.target)


def run(file: StudyFile, participant: int = 0, seed: int = 1, most: int = 1000) -> list[tuple[Trial, Answer]]:
    course, generator, done = StudyCourse(file, participant), np.random.default_rng(seed), []
    while (trial := course.next()) is not None and len(done) < most:
        assert course.next() == trial
        response = str(generator.choice(trial.choices))
        done.append((trial, as_answer(len(done) + 1, trial, response)))
        course.take(trial, response)
    return done


def test_adjustments_and_positions_come_in_turn_and_equally_often(file: StudyFile):
    tests = [trial for trial, _ in run(file) if trial.comparison == "odd" and trial.phase == "test"]
    assert set(Counter((test.position, test.intervals[test.position - 1].condition) for test in tests).values()) == {2}
    assert all(Counter(test.intervals).most_common()[0][1] == 2 for test in tests)
    levels = [trial for trial, _ in run(file) if trial.comparison == "levels"]
    assert set(Counter((level.level, level.position) for level in levels).values()) == {2}
    tests = [trial for trial, _ in run(file) if trial.comparison == "differ" and trial.phase == "test"]
    pairs = Counter((*(interval.condition for interval in trial.intervals), trial.target) for trial in tests)
    assert pairs == {
        ("one", "two", "different"): 2, ("two", "one", "different"): 2,
        ("one", "one", "same"): 2, ("two", "two", "same"): 2,
    }  # fmt: skip
    begins: dict[str, set[tuple[float, ...]]] = {"one": set(), "two": set()}
    for seed in range(6):
        course = Adjustment().course(file.study.comparison("equal"), np.random.default_rng(seed))
        trials = []
        while (trial := course.next()) is not None:
            trials.append(trial)
            course.take(trial, trial.choices[2])
        assert Counter(each.condition for each in trials) == {"one": 2, "two": 2}
        for name in begins:
            own = [each for each in trials if each.condition == name]
            assert all(each.intervals[0] == Stimulus(name, 0.002) for each in own), "the standard comes first"
            assert [each.level for each in own] == [each.intervals[1].level for each in own]
            begins[name].add(tuple(each.level for each in own))
        assert trials[0].choices == ("0.001", "0.0015", "0.002", "0.0025", "0.003")
    both = {(0.001, 0.003), (0.003, 0.001)}
    assert begins == {"one": both, "two": both}


@pytest.mark.parametrize("done", [1, 17, 50, 63])
def test_replayed_answers_lead_to_the_same_next_trial(file: StudyFile, done: int):
    whole, course = run(file), StudyCourse(file, 0)
    assert len(whole) == course.trials and whole != run(file, 1)
    assert replay(course, [answer for _, answer in whole[:done]]) == done
    assert course.next() == (whole[done][0] if done < len(whole) else None)


def test_quest_goes_where_the_threshold_is_and_takes_no_other_answers(file: StudyFile):
    answers = [answer for _, answer in run(file)]
    with pytest.raises(ResultsError, match="trial 2: is an answer to another trial"):
        replay(StudyCourse(file, 0), [answers[0], answers[-1].__class__(**{**vars(answers[1]), "position": 99})])
    course, levels = StudyCourse(file, 0), []
    while (trial := course.next()) is not None:
        response = trial.choices[0]
        if trial.comparison == "quest":
            levels.append(trial.level)
            other = "2" if trial.position == 1 else "1"
            response = str(trial.position) if trial.level > 0.0024 else other
        course.take(trial, response)
    late = Counter(levels[8:])
    assert late[0.002] + late[0.0025] > len(levels[8:]) / 2


def test_places_come_equally_often_or_in_the_order_of_the_file(tmp_path: Path):
    for count in (2, 3, 4, 5, 6):
        rows = [latin_square(count, row) for row in range(count * (1 + count % 2))]
        turns = len(rows) // count
        assert set(Counter((place, each) for row in rows for place, each in enumerate(row)).values()) == {turns}
        neighbours = Counter(pair for row in rows for pair in pairwise(row))
        assert len(neighbours) == count * (count - 1)
        assert len(set(neighbours.values())) == 1
    (tmp_path / "feel.yaml").write_text("scene: builtin/brick\nwant: touch\nrender: proxy\ndevice: mock\n")
    written = parse_study(f"order: as-written\n{STUDY}", tmp_path / "study.yaml")
    drawn = parse_study(f"order: random\n{STUDY}", tmp_path / "study.yaml")
    assert [comparison_order(written, each) for each in (0, 1)] == [list(range(8))] * 2
    assert len({tuple(comparison_order(drawn, each)) for each in range(8)}) > 4


@pytest.mark.parametrize(
    ("question", "more", "response", "expected"),
    [
        ("higher", {"level": 2.0, "standard": 1.0, "position": 2}, "2", (1, 1)),
        ("higher", {"level": 0.5, "standard": 1.0, "position": 2}, "2", (1, 0)),
        ("higher", {"level": 1.0, "standard": 1.0, "position": 2}, "1", (0, None)),
        ("rougher", {"position": 1}, "1", (1, None)),
        ("same", {"position": 1}, "3", (None, 0)),
        ("different", {"target": "same"}, "different", (None, 0)),
        ("name", {"target": "cup"}, "cup", (None, 1)),
        ("rating", {}, "4", (None, None)),
    ],
)
def test_response_means(question: str, more: dict, response: str, expected: tuple[int | None, int | None]):
    assert score(Trial("a", question, "any", (), (), "x", **more), response) == expected
