"""Questions to a participant, their keys, and what was right: a wrong key would be a wrong answer in the results."""

import pytest

from tangible_study.design import Comparison, Scale
from tangible_study.procedures import Trial
from tangible_study.questions import load_question

PARTS = ("cup", "plate", "knife")
RATED = Comparison(name="c", question="rating", scale=Scale(of="the grain", ends=("low", "high")))


def trial(asked: str, *given: str, **more) -> Trial:
    return Trial("c", asked, "any", (), given, "one", **more)


@pytest.mark.parametrize(
    ("asked", "word", "keys", "responses"),
    [
        (trial("rougher", "1", "2"), "rougher", {"1": "", "2": ""}, "12"),
        (trial("higher", "1", "2"), "higher", {"1": "", "2": ""}, "12"),
        (trial("same", *"123"), "not the same", {"1": "", "2": "", "3": ""}, "123"),
        (
            trial("different", "same", "different"),
            "or different",
            {"1": "they were the same", "2": "they were different"},
            ["same", "different"],
        ),
        (trial("name", *PARTS), "part", {"1": "cup", "2": "plate", "3": "knife"}, PARTS),
        (trial("rating", *"0123"), "the grain", {"0": "low", "1": "", "2": "", "3": "high"}, "0123"),
        (
            trial("equal", "0.1", "0.2"),
            "equal to interval 1",
            {"1": "no, it needs more", "2": "no, it needs less", "3": "yes, it was equal"},
            ["0.2"] * 3,
        ),
    ],
)
def test_question_has_its_keys_and_each_key_its_response(asked: Trial, word: str, keys: dict, responses):
    question = load_question(asked.question)
    assert word in question.ask(RATED)
    assert list(question.choices(asked, RATED).items()) == list(keys.items())
    assert [question.response(asked, key, 0.2) for key in keys] == list(responses)


def right_answer(asked: Trial) -> str:
    return load_question(asked.question).right_answer(asked)


def test_right_answer_is_the_interval_or_the_word():
    assert right_answer(trial("name", *PARTS, target="plate")) == "plate"
    assert right_answer(trial("same", *"123", position=3, level=2.0, standard=1.0)) == "3"
    assert right_answer(trial("rougher", *"12", position=2)) == ""
    for position, level, right in ((1, 2.0, "1"), (2, 2.0, "2"), (1, 0.5, "2"), (2, 0.5, "1"), (2, 1.0, "")):
        assert right_answer(trial("higher", *"12", position=position, level=level, standard=1.0)) == right
