"""What a participant is asked, by which keys it is answered, and what was right."""

import pytest

from tangible_study.design.study import Comparison, Scale
from tangible_study.procedures import Trial
from tangible_study.session.words import choices, question, response, right_answer

PARTS = ("cup", "plate", "knife")


def trial(asked: str, *given: str, **more) -> Trial:
    return Trial("c", asked, "any", (), given, "one", **more)


@pytest.mark.parametrize(
    ("asked", "text", "keys", "responses"),
    [
        (trial("rougher", "1", "2"), "Which interval was rougher?", {"1": "", "2": ""}, "12"),
        (trial("higher", "1", "2"), "Which interval was higher?", {"1": "", "2": ""}, "12"),
        (trial("same", *"123"), "Which interval was not the same as the others?", {"1": "", "2": "", "3": ""}, "123"),
        (
            trial("different", "same", "different"),
            "Were the two intervals the same, or different?",
            {"1": "they were the same", "2": "they were different"},
            ["same", "different"],
        ),
        (trial("name", *PARTS), "Which part was this?", {"1": "cup", "2": "plate", "3": "knife"}, PARTS),
        (
            trial("rating", *"0123"),
            "How would you rate the grain?",
            {"0": "low", "1": "", "2": "", "3": "high"},
            "0123",
        ),
    ],
)
def test_question_has_its_keys_and_each_key_its_response(asked: Trial, text: str, keys: dict, responses):
    comparison = Comparison(name="c", question="rating", scale=Scale(of="the grain", ends=("low", "high")))
    assert question(asked, comparison) == text
    assert choices(asked, comparison) == keys
    assert [response(asked, key) for key in keys] == list(responses)


def test_rating_without_words_and_adjustment():
    plain, adjusted = Comparison(name="c", question="rating"), trial("equal", "0.1", "0.2")
    assert question(trial("rating", *"12"), plain) == "Which number fits best?"
    assert choices(trial("rating", *"12"), plain) == {"1": "", "2": ""}
    assert question(adjusted, plain) == "Was interval 2 equal to interval 1?"
    assert list(choices(adjusted, plain).items()) == [
        ("1", "no, it needs more"),
        ("2", "no, it needs less"),
        ("3", "yes, it was equal"),
    ]


@pytest.mark.parametrize(
    ("asked", "right"),
    [
        (trial("name", *PARTS, target="plate"), "plate"),
        (trial("same", *"123", position=3, level=2.0, standard=1.0), "3"),
        (trial("higher", *"12", position=1, level=2.0, standard=1.0), "1"),
        (trial("higher", *"12", position=2, level=2.0, standard=1.0), "2"),
        (trial("higher", *"12", position=1, level=0.5, standard=1.0), "2"),
        (trial("higher", *"12", position=2, level=0.5, standard=1.0), "1"),
        (trial("higher", *"12", position=2, level=1.0, standard=1.0), ""),
        (trial("rougher", *"12", position=2), ""),
        (trial("equal", "1", "2", level=2.0, standard=1.0), ""),
    ],
)
def test_right_answer_is_the_interval_or_the_word(asked: Trial, right: str):
    assert right_answer(asked) == right
