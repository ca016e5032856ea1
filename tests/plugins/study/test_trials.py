"""Study files, questions and the table of answers: a mistake that nobody names would cost or falsify an answer."""

import io
import os
from pathlib import Path

import numpy as np
import pytest

from tangible_core.data import TICK_COLUMNS, TickFlag
from tangible_core.errors import ConfigError, OutputError, ResultsError
from tangible_study.analysis.analysing import read_results
from tangible_study.design import Comparison, Limits, Scale
from tangible_study.desks.desk import LEAVE, ParticipantLeft, Terminal
from tangible_study.presenting.presenter import Rendering
from tangible_study.procedures import Trial
from tangible_study.questions import load_question
from tangible_study.session.folder import Participant, participants
from tangible_study.study_file import parse_study
from tangible_study.trials import COLUMNS, Answer, AnswerFile, read_answers

FIRST = Answer(
    1, "test", "a", "same", "oddity", "one", "two", None, None, 3, "2", None, 0, 1.25, 1, False, "why", "r.nc"
)
SECOND = Answer(2, "training", "b", "name", "naming", "ice cream", level=0.1 + 0.2, response="a\tb\nc", target="Öl")


def test_answers_are_read_as_they_were_written_by_one_program(tmp_path: Path):
    with AnswerFile(tmp_path / "a.tsv") as table:
        table.add(FIRST)
        table.add(SECOND)
    first, second = read_answers(tmp_path / "a.tsv")
    assert first == FIRST
    assert second == Answer(**{**vars(SECOND), "response": "a b c"})
    assert (tmp_path / "a.tsv").read_text(encoding="utf-8").splitlines()[0].split("\t") == list(COLUMNS)
    with AnswerFile(tmp_path / "a.tsv"), pytest.raises(OutputError, match="another program runs this participant"):
        AnswerFile(tmp_path / "a.tsv")


def test_answer_is_on_the_disk_when_add_returns(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    with AnswerFile(tmp_path / "a.tsv") as table:
        synced = list[str]()
        monkeypatch.setattr(os, "fsync", lambda _: synced.append((tmp_path / "a.tsv").read_text()))
        table.add(FIRST)
    assert synced[-1].endswith(f"{FIRST.line()}\n")


def test_damaged_and_cut_off_lines_are_named_or_removed(tmp_path: Path):
    with AnswerFile(tmp_path / "a.tsv") as table:
        table.add(FIRST)
    with (tmp_path / "a.tsv").open("a") as file:
        file.write("2\ttest\ta")
    assert read_answers(tmp_path / "a.tsv") == [FIRST]
    with AnswerFile(tmp_path / "a.tsv") as table:
        table.add(Answer(**{**vars(FIRST), "trial": 2}))
    assert [answer.trial for answer in read_answers(tmp_path / "a.tsv")] == [1, 2]
    with AnswerFile(tmp_path / "a.tsv") as table:
        table.add(FIRST)
    text = (tmp_path / "a.tsv").read_text()
    (tmp_path / "a.tsv").write_text(text.replace("false", "maybe"))
    with pytest.raises(ResultsError, match=r"a\.tsv:2: is not an answer"):
        read_answers(tmp_path / "a.tsv")


def test_full_disk_leaves_the_table_as_it_was_and_the_answer_can_be_added_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    with AnswerFile(tmp_path / "a.tsv") as table:
        table.add(FIRST)
        before = (tmp_path / "a.tsv").read_bytes()
        with monkeypatch.context() as full:
            full.setattr(os, "fsync", lambda _: (_ for _ in ()).throw(OSError(28, "No space left on device")))
            with pytest.raises(OutputError, match="No space left on device; free some space"):
                table.add(SECOND)
        assert (tmp_path / "a.tsv").read_bytes() == before
        table.add(SECOND)
    assert len(read_answers(tmp_path / "a.tsv")) == 2


def test_participants_are_the_same_by_a_list_or_another_name(tmp_path: Path):
    rows = ["participant_id;language;started;finished", "sub-P7;de;2026-01-02T03:04:05;n/a"]
    (tmp_path / "participants.tsv").write_text("\r\n".join(rows), encoding="utf-8-sig")
    assert participants(tmp_path) == [Participant("sub-P7", "de", "2026-01-02T03:04:05")]
    (tmp_path / "study.yaml").touch()
    (tmp_path / "sub-P7" / "beh").mkdir(parents=True)
    (tmp_path / "sub-P7" / "beh" / "sub-P7_task-s_beh.csv").touch()
    with pytest.raises(ResultsError, match=r"rename it to sub-P7_task-s_beh\.tsv"):
        read_results(tmp_path)


TIME, LATE, FLAGS = (TICK_COLUMNS.index(each) for each in ("time_s", "late_s", "flags"))


def ticks(count: int, flag: int, share: float) -> Rendering:
    """Return the rendering of ticks that touch, of which a share has a flag."""
    rows = np.zeros((count, len(TICK_COLUMNS)))
    rows[:, TIME] = np.arange(count) / 1000
    rows[:, FLAGS] = TickFlag.TOUCHING
    rows[: round(share * count), FLAGS] += flag
    rendering = Rendering()
    rendering.add(rows[: count // 2])
    rendering.add(rows[count // 2 :])
    return rendering


@pytest.mark.parametrize(
    ("share", "said"),
    [(0.01, None), (0.011, "1 % of the ticks came too late"), (0.03, "3 % of the ticks came too late")],
)
def test_share_of_late_ticks_marks_a_trial(share: float, said: str | None):
    assert ticks(1000, TickFlag.OVERRUN, share).why_not(Limits()) == said


def test_ticks_are_counted_in_contact_and_by_lateness():
    rendering = ticks(1000, TickFlag.SLEW_LIMITED, 0.02)
    assert rendering.why_not(Limits()) == (
        "the force was delayed, as it changed too quickly, in 2 % of the time in contact"
    )
    for most, marked in ((0.05, False), (0.02, False), (0.019, True)):
        assert (rendering.why_not(Limits(limited=most)) is not None) == marked
    assert (rendering.ticks, rendering.last_s) == (1000, 0.999)
    rendering = Rendering()
    for longer in (1, 2):
        rows = np.zeros((101, len(TICK_COLUMNS)))
        rows[:, LATE] = longer * np.arange(101) * 1e-6
        rendering.add(rows)
    rendering.add(rows[:0])
    assert rendering.late_s == pytest.approx([99e-6, 100e-6, 198e-6, 200e-6])
    assert rendering.ticks == 202


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
