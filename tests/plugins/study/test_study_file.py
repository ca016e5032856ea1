"""Study files: each mistake is named with its line and place before anybody sits down."""

from pathlib import Path

import pytest

from tangible_core.errors import ConfigError
from tangible_study.study_file import parse_study

CONDITIONS = "study: s\npipeline: feel.yaml\nconditions:\n  one: {}\n  two: {set: {render.use: penalty}}\n"
LEVELS = "vary: workspace.relief_m, levels: [0.001, 0.002], standard: 0.002"


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "feel.yaml").write_text("scene: builtin/brick\nwant: touch\nrender: proxy\ndevice: mock\n")
    return tmp_path


def complaint(text: str, folder: Path) -> str:
    with pytest.raises(ConfigError) as raised:
        parse_study(text, folder / "study.yaml")
    return str(raised.value).removeprefix(f"{folder}/")


@pytest.mark.parametrize(
    ("text", "place", "words"),
    [
        ("study: s\n", "1:1", "asks nothing"),
        ("study: s\npipelne: feel.yaml\n", "2:1", "unknown option (did you mean 'pipeline'?)"),
        (f"{CONDITIONS}comparisons:\n- {{name: a, question: same, conditions: [one]}}\n", "7:3", "one condition only"),
        (
            f"{CONDITIONS}comparisons:\n- {{name: a, question: rating, conditions: [one]}}\n",
            "7:3",
            "one condition only",
        ),
        (
            f"{CONDITIONS}comparisons:\n- {{name: a, question: higher, {LEVELS}}}\n".replace(
                "0.001, 0.002", "0.002, 0.001"
            ),
            "7:57",
            "levels: must rise, each once",
        ),
        (f"{CONDITIONS}comparisons:\n- {{name: a, question: same, {LEVELS}}}\n", "7:3", "the standard from itself"),
        (f"{CONDITIONS}comparisons:\n- {{name: a, question: same, conditions: [on, two]}}\n", "7:42", "mean 'one'?"),
        (f"{CONDITIONS}comparisons:\n- {{name: a, question: smae}}\n", "7:13", "did you mean 'same'?"),
        (f"{CONDITIONS}comparisons:\n- {{name: a, question: same, procedure: odity}}\n", "7:29", "mean 'oddity'?"),
        (f"{CONDITIONS}comparisons:\n- {{name: a, question: equal, procedure: 2afc}}\n", "7:3", "does not ask for"),
        (f"{CONDITIONS}comparisons:\n- {{name: a, question: equal}}\n", "7:3", "write the key that varies"),
        (f"{CONDITIONS}comparisons:\n- {{name: a, question: name, names: [x]}}\n", "7:3", "two different `names:`"),
        (
            f"{CONDITIONS}comparisons:\n- {{name: a, question: same}}\n- {{name: a, question: rating}}\n",
            "8:4",
            "two comparisons are called 'a'",
        ),
        (
            f"{CONDITIONS}comparisons:\n- {{name: a, question: higher, {LEVELS}, conditions: [one]}}\n".replace(
                "relief_m", "relif_m"
            ),
            "7:31",
            "did you mean 'relief_m'?",
        ),
        (
            f"{CONDITIONS}comparisons:\n- {{name: a, question: higher, {LEVELS}, conditions: [one]}}\n".replace(
                "[0.001, 0.002]", "[0.001, 20]"
            ),
            "7:73",
            "less than or equal to 1, not 20",
        ),
        (
            f"{CONDITIONS}comparisons:\n- {{name: a, question: same}}\n".replace("penalty", "penlty"),
            "5:15",
            "did you mean 'penalty'?",
        ),
    ],
)
def test_mistake_is_named_with_its_place_and_cure(folder: Path, text: str, place: str, words: str):
    first = complaint(text, folder).splitlines()[0]
    assert first.startswith(f"study.yaml:{place}: ")
    assert words in first


def test_condition_without_a_pipeline_is_refused(folder: Path):
    text = "study: s\nconditions: {one: {}}\ncomparisons: [{name: a, question: rating}]\n"
    assert "one: has no pipeline" in complaint(text, folder)


def test_digest_follows_the_text(folder: Path):
    text = f"{CONDITIONS}comparisons:\n- {{name: a, question: same}}\n"
    first, second = (parse_study(each, folder / "study.yaml") for each in (text, f"{text}# changed\n"))
    assert first.digest != second.digest
    assert first.study == second.study
