"""If one of these fails, lines of a file or a table are lost, torn after a kill, or passed over without a word."""

import os
from collections.abc import Callable
from io import FileIO
from pathlib import Path

import pytest

from full_disk import unreadable
from tangible_core.errors import OutputError, ResultsError
from tangible_core.files import line_file
from tangible_core.files.line_file import JsonLines, LineFile, read_lines, read_rows
from tangible_core.files.tables import read_table


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


def test_line_file_in_use_says_so_and_one_that_is_not_locked_is_shared(tmp_path):
    path = tmp_path / "lines.txt"
    with LineFile(path, in_use="is busy"), pytest.raises(OutputError, match=r"lines.txt: is busy$"):
        LineFile(path, in_use="is busy")
    with LineFile(path) as one, LineFile(path) as other:
        one.add("one")
        other.add("two")
    assert list(read_lines(path)) == [(1, "one"), (2, "two")]


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


def test_rows_are_read_as_they_were_added_or_say_why_not(tmp_path: Path):
    rows = [{"a": 1, "b": [None, "ö"]}, {}]
    with JsonLines(tmp_path / "a.jsonl") as file:
        for row in rows:
            file.add_row(row)
    assert list(read_rows(tmp_path / "a.jsonl")) == [(1, rows[0]), (2, rows[1])]
    assert list(read_rows(tmp_path / "missing.jsonl")) == []
    for path, why in unreadable(tmp_path, ".jsonl"):
        with pytest.raises(ResultsError) as error:
            list(read_rows(path))
        assert str(error.value) == f"{path}: cannot be read as rows: {why}; name another folder"


@pytest.mark.parametrize("line", ["[1]", "1", "{", "[" * 100_000])
def test_line_that_is_no_row_is_named(tmp_path: Path, line: str):
    (tmp_path / "a.jsonl").write_text('{"a": 1}\n\n' + line + "\n")
    with pytest.raises(ResultsError, match=r"a\.jsonl:3: "):
        list(read_rows(tmp_path / "a.jsonl"))


ROWS = [["one", "0.08", "a b"], ["two", "-1.5e-3", ""]]


def german(lines: list[list[str]]) -> str:
    return "\r\n".join(";".join(cell.replace(".", ",") for cell in line) for line in lines) + "\r\n"


SAVED: dict[str, Callable[[list[list[str]]], bytes]] = {
    "ours": lambda lines: "".join(",".join(line) + "\n" for line in lines).encode(),
    "mail": lambda lines: "\r\n".join(",".join(line) for line in lines).encode(),
    "old line ends": lambda lines: "\r".join(",".join(line) for line in lines).encode(),
    "quoted": lambda lines: "".join(",".join(f'"{cell}"' for cell in line) + "\n" for line in lines).encode(),
    "byte-order mark": lambda lines: b"\xef\xbb\xbf" + "".join(",".join(line) + "\n" for line in lines).encode(),
    "German": lambda lines: german(lines).encode(),
    "German with mark and quotes": lambda lines: b"\xef\xbb\xbf" + german(lines).replace("a b", '"a b"').encode(),
    "tabs": lambda lines: "".join("\t".join(line) + "\n" for line in lines).encode(),
    "empty columns and lines": lambda lines: ("".join(",".join(line) + ",,\n" for line in lines) + ",,,,\n\n").encode(),
}


@pytest.mark.parametrize("save", SAVED.values(), ids=SAVED)
def test_table_is_the_same_whatever_program_saved_it(tmp_path: Path, save: Callable[[list[list[str]]], bytes]):
    (tmp_path / "a.csv").write_bytes(save([["id", "width", "title"], *ROWS]))
    columns, rows = read_table(tmp_path / "a.csv")
    assert columns == ["id", "width", "title"]
    assert [list(cells.values()) for _, cells in rows] == ROWS


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("id,title\na,\"b\nc,d\n", "line 3 is not of a table: unexpected end of data; correct its quotes"),
        ("id,title\na,b,c\n", "line 2 has more cells than there are columns"),
        ("id,id\na,b\n", "two columns 'id'"),
    ],
)  # fmt: skip
def test_row_that_would_be_passed_over_is_refused(tmp_path: Path, text: str, why: str):
    (tmp_path / "a.csv").write_text(text)
    with pytest.raises(ValueError, match=why):
        list(read_table(tmp_path / "a.csv")[1])
