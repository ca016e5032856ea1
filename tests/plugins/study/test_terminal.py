"""The terminal of a study: each question is a line with its keys, and each answer is a key and Enter."""

import io
from typing import TextIO

import pytest

from tangible_study.desks.desk import LEAVE, Left, Terminal

GERMAN = {"Which one is rougher?": "Was ist rauer?", "the first": "das erste"}
CHOICES = {"1": "the first", "2": "", "": "begin"}


class Typed(TextIO):
    """What was typed, as lines."""

    def __init__(self, text: str) -> None:
        self._lines = io.StringIO(text)

    def readline(self, limit: int = -1) -> str:
        return self._lines.readline(limit)

    def isatty(self) -> bool:
        return False


def terminal(typed: str) -> tuple[Terminal, list[str]]:
    """Return a terminal at which this is typed, and the lines that it writes."""
    lines: list[str] = []
    return Terminal(Typed(typed), lines.append, lambda text: GERMAN.get(text, text)), lines


@pytest.mark.parametrize(("typed", "answer"), [("1\n", "1"), (" 2 \n1\n", "2"), ("\n", ""), ("1", "1")])
def test_question_is_written_once_with_its_keys_and_answered_by_a_line(typed: str, answer: str):
    desk, lines = terminal(typed)
    assert desk.ask("Which one is rougher?", CHOICES) == answer
    assert lines == ["Was ist rauer? (1 = das erste, 2)"]


def test_letter_is_the_same_key_in_either_case():
    assert terminal("Y\n")[0].ask("Ready?", {"y": "yes"}) == "y"


def test_key_without_meaning_is_told_and_the_question_asked_again():
    desk, lines = terminal("3\n12\n2\n")
    assert desk.ask("Ready?", {"2": "yes"}) == "2"
    question, refusal = "Ready? (2 = yes)", "That key has no meaning here."
    assert lines == [question, refusal, question, refusal, question]


@pytest.mark.parametrize("typed", [f"{LEAVE}\n", f"{LEAVE.upper()}\n1\n", "", "5\n"])
def test_participant_leaves_by_a_key_or_at_the_end_of_what_is_typed(typed: str):
    with pytest.raises(Left):
        terminal(typed)[0].ask("Ready?", {"1": ""})


def test_question_without_keys_is_the_text_alone():
    desk, lines = terminal("\n")
    desk.say("Which one is rougher?")
    assert desk.ask("Press Enter.", {"": "go on"}) == ""
    assert lines == ["Was ist rauer?", "Press Enter."]
    assert not desk.stop.is_set()
