"""The terminal of a study: a key that is taken for another one would falsify an answer without anybody noticing."""

import io

import pytest

from tangible_study.desks.desk import LEAVE, ParticipantLeft, Terminal

GERMAN = {"Which one is rougher?": "Was ist rauer?", "the first": "das erste"}


def terminal(typed: str) -> tuple[Terminal, list[str]]:
    """Return a terminal at which this is typed, and the lines that it writes."""
    lines: list[str] = []
    return Terminal(io.StringIO(typed), lines.append, lambda text: GERMAN.get(text, text)), lines


@pytest.mark.parametrize(
    ("typed", "answer", "questions"), [("1\n", "1", 1), (" 2 \n1\n", "2", 1), ("\n", "", 1), ("3\n12\nY", "y", 3)]
)
def test_question_is_written_with_its_keys_and_answered_by_a_line(typed: str, answer: str, questions: int):
    desk, lines = terminal(typed)
    desk.say("Which one is rougher?")
    assert desk.ask("Which one is rougher?", {"1": "the first", "2": "", "y": "yes", "": "begin"}) == answer
    asked, refused = "Was ist rauer? (1 = das erste, 2, y = yes)", "That key has no meaning here."
    assert lines == ["Was ist rauer?", asked, *[refused, asked] * (questions - 1)]
    assert not desk.stop.is_set()


@pytest.mark.parametrize("typed", [f"{LEAVE.upper()}\n1\n", "", "5\n"])
def test_participant_leaves_by_a_key_or_at_the_end_of_what_is_typed(typed: str):
    with pytest.raises(ParticipantLeft):
        terminal(typed)[0].ask("Ready?", {"1": ""})
