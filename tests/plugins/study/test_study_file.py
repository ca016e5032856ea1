"""Study files: a mistake that is not named before anybody sits down costs a participant."""

from pathlib import Path

import pytest

from tangible_core.errors import ConfigError
from tangible_study.study_file import parse_study

HEAD = "study: s\npipeline: feel.yaml\nconditions:\n  one: {}\n  two: {set: {render.use: penalty}}\ncomparisons:\n"
HIGHER = "name: a, question: higher, vary: workspace.relief_m, levels: [0.001, 0.002], standard: 0.002"
MISTAKES = (
    ("name: a, question: same, conditions: [one]", "7:3", "one condition"),
    ("name: a, question: rating, conditions: [one]", "7:3", "one condition"),
    (HIGHER.replace("0.001, 0.002", "0.002, 0.001"), "7:57", "must rise"),
    (HIGHER.replace("higher", "same"), "7:3", "the standard from itself"),
    (
        HIGHER.replace("higher", "same").replace("0.002]", "0.003]") + ", procedure: quest, conditions: [one]",
        "7:3",
        "equally far from the standard",
    ),
    (HIGHER.replace("higher", "different"), "7:3", "no levels"),
    (HIGHER.replace("relief_m", "relif_m") + ", conditions: [one]", "7:31", "'relief_m'"),
    (HIGHER.replace("[0.001, 0.002]", "[0.001, 20]") + ", conditions: [one]", "7:73", "not 20"),
    ("name: a, question: same, conditions: [on, two]", "7:42", "'one'"),
    ("name: a, question: smae", "7:13", "'same'"),
    ("name: a, question: same, procedure: odity", "7:29", "'oddity'"),
    ("name: a, question: equal, procedure: 2afc", "7:3", "does not ask"),
    ("name: a, question: same, procedure: same-different", "7:3", "does not ask"),
    ("name: a, question: equal", "7:3", "key that varies"),
    ("name: a, question: name, names: [x, x]", "7:3", "two different"),
    ("name: a, question: rating, scale: {least: 7}", "7:3", "two numbers"),
    ("name: a, question: same}\n- {name: a, question: rating", "8:4", "'a'"),
)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "feel.yaml").write_text("scene: builtin/brick\nwant: touch\nrender: proxy\ndevice: mock\n")
    return tmp_path


@pytest.mark.parametrize(
    ("text", "place", "words"),
    [
        ("study: s\n", "1:1", "asks nothing"),
        ("study: s\npipelne: feel.yaml\n", "2:1", "'pipeline'"),
        (f"{HEAD}- {{name: a, question: same}}\n".replace("penalty", "penlty"), "5:15", "'penalty'"),
        (f"{HEAD}- {{name: a, question: same}}\n".replace("pipeline: feel.yaml\n", ""), "3:3", "no pipeline"),
        *((f"{HEAD}- {{{comparison}}}\n", place, words) for comparison, place, words in MISTAKES),
    ],
)
def test_mistake_is_named_with_its_place(folder: Path, text: str, place: str, words: str):
    with pytest.raises(ConfigError) as raised:
        parse_study(text, folder / "study.yaml")
    first = str(raised.value).splitlines()[0]
    assert first.startswith(f"{folder / 'study.yaml'}:{place}: ") and words in first


def test_digest_follows_the_text(folder: Path):
    text = f"{HEAD}- {{name: a, question: same}}\n"
    first, second = (parse_study(each, folder / "study.yaml") for each in (text, f"{text}# changed\n"))
    assert first.digest != second.digest and first.study == second.study
