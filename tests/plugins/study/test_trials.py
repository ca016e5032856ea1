"""The table of answers: whole lines, on the disk at once, whatever happens."""

import os
from pathlib import Path

import pytest

from tangible_core.errors import OutputError, ResultsError
from tangible_study.analysis.analysing import read_results
from tangible_study.session.folder import Participant, participants
from tangible_study.trials import COLUMNS, Answer, AnswerFile, read_answers

FIRST = Answer(
    1, "test", "a", "same", "oddity", "one", "two", None, None, 3, "2", None, 0, 1.25, 1, False, "why", "r.nc"
)
SECOND = Answer(2, "training", "b", "name", "naming", "ice cream", level=0.1 + 0.2, response="a\tb\nc", target="Öl")


def test_answers_are_read_as_they_were_written(tmp_path: Path):
    with AnswerFile(tmp_path / "a.tsv") as table:
        table.add(FIRST)
        table.add(SECOND)
    first, second = read_answers(tmp_path / "a.tsv")
    assert first == FIRST
    assert second == Answer(**{**vars(SECOND), "response": "a b c"})
    assert (tmp_path / "a.tsv").read_text(encoding="utf-8").splitlines()[0].split("\t") == list(COLUMNS)


def test_answer_is_on_the_disk_when_add_returns(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    with AnswerFile(tmp_path / "a.tsv") as table:
        synced = list[str]()
        monkeypatch.setattr(os, "fsync", lambda _: synced.append((tmp_path / "a.tsv").read_text()))
        table.add(FIRST)
    assert synced[-1].endswith(f"{FIRST.line()}\n")


def test_line_that_a_crash_cut_off_is_removed(tmp_path: Path):
    with AnswerFile(tmp_path / "a.tsv") as table:
        table.add(FIRST)
    with (tmp_path / "a.tsv").open("a") as file:
        file.write("2\ttest\ta")
    assert read_answers(tmp_path / "a.tsv") == [FIRST]
    with AnswerFile(tmp_path / "a.tsv") as table:
        table.add(Answer(**{**vars(FIRST), "trial": 2}))
    assert [answer.trial for answer in read_answers(tmp_path / "a.tsv")] == [1, 2]


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


def test_two_programs_do_not_write_one_table(tmp_path: Path):
    with AnswerFile(tmp_path / "a.tsv"), pytest.raises(OutputError, match="another program runs this participant"):
        AnswerFile(tmp_path / "a.tsv")


def test_damaged_line_is_named(tmp_path: Path):
    with AnswerFile(tmp_path / "a.tsv") as table:
        table.add(FIRST)
    text = (tmp_path / "a.tsv").read_text()
    (tmp_path / "a.tsv").write_text(text.replace("false", "maybe"))
    with pytest.raises(ResultsError, match=r"a\.tsv:2: is not an answer"):
        read_answers(tmp_path / "a.tsv")


def test_list_of_participants_from_a_spreadsheet_is_the_same(tmp_path: Path):
    rows = ["participant_id;language;started;finished", "sub-P7;de;2026-01-02T03:04:05;n/a"]
    (tmp_path / "participants.tsv").write_text("\r\n".join(rows), encoding="utf-8-sig")
    assert participants(tmp_path) == [Participant("sub-P7", "de", "2026-01-02T03:04:05")]


def test_answers_under_another_name_are_not_passed_over(tmp_path: Path):
    (tmp_path / "study.yaml").touch()
    (tmp_path / "sub-P7" / "beh").mkdir(parents=True)
    (tmp_path / "sub-P7" / "beh" / "sub-P7_task-s_beh.csv").touch()
    with pytest.raises(ResultsError, match=r"rename it to sub-P7_task-s_beh\.tsv"):
        read_results(tmp_path)
