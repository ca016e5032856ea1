"""If one of these fails, lines are lost or torn after a kill, on a full disk, or with two writers."""

import os
from io import FileIO

import pytest

from tangible_core.errors import OutputError
from tangible_core.files import line_file
from tangible_core.files.line_file import LineFile, read_lines


@pytest.mark.parametrize(
    ("before", "after"),
    [
        (b"", b"head\nnew\n"),
        (b"he", b"head\nnew\n"),
        (b"head\n", b"head\nnew\n"),
        (b"head\none\ntw", b"head\none\nnew\n"),
        (b"head\none\n\xc3", b"head\none\nnew\n"),
    ],
)
def test_line_file_cuts_a_torn_end_and_has_one_header(tmp_path, before, after):
    path = tmp_path / "folder" / "lines.txt"
    path.parent.mkdir()
    path.write_bytes(before)
    with LineFile(path, header="head") as file:
        file.add("new")
    assert path.read_bytes() == after


@pytest.mark.parametrize(("every_s", "synced"), [(0.0, 3), (60.0, 1)])
def test_line_file_waits_for_the_disk_as_often_as_requested(tmp_path, monkeypatch, every_s, synced):
    calls = []
    monkeypatch.setattr(os, "fsync", calls.append)
    with LineFile(tmp_path / "lines.txt", sync_every_s=every_s) as file:
        file.add("one")
        file.add("two")
    assert len(calls) == synced


def test_line_file_on_a_full_disk_is_as_before_and_takes_the_line_later(tmp_path, monkeypatch):
    class Full(FileIO):
        room = 6

        def write(self, data):
            return super().write(bytes(data)[: Full.room])

    monkeypatch.setattr(line_file, "FileIO", Full)
    path = tmp_path / "lines.txt"
    with LineFile(path) as file:
        file.add("first")
        with pytest.raises(OutputError, match=r"lines.txt: cannot be written: No space left .*; free some space"):
            file.add("second")
        assert path.read_bytes() == b"first\n"
        Full.room = 100
        file.add("second")
    assert path.read_bytes() == b"first\nsecond\n"


def test_line_file_in_use_says_so_and_one_that_is_not_locked_is_shared(tmp_path):
    path = tmp_path / "lines.txt"
    with LineFile(path, in_use="is busy"), pytest.raises(OutputError, match=r"lines.txt: is busy$"):
        LineFile(path, in_use="is busy")
    with LineFile(path) as one, LineFile(path) as other:
        one.add("one")
        other.add("two")
    assert list(read_lines(path)) == [(1, "one"), (2, "two")]
