"""If one of these fails, rows of results are lost, or a damaged line is passed over."""

from pathlib import Path

import pytest

from tangible_core.errors import ResultsError
from tangible_core.files.line_file import JsonLines, read_rows
from unreadable import unreadable


def test_rows_are_read_as_they_were_added_and_a_missing_file_has_none(tmp_path: Path):
    rows = [{"a": 1, "b": [None, "ö"]}, {}]
    with JsonLines(tmp_path / "a.jsonl") as file:
        for row in rows:
            file.add_row(row)
    assert list(read_rows(tmp_path / "a.jsonl")) == [(1, rows[0]), (2, rows[1])]
    assert list(read_rows(tmp_path / "missing.jsonl")) == []


def test_rows_that_cannot_be_read_say_why(tmp_path: Path):
    for path, why in unreadable(tmp_path, ".jsonl"):
        with pytest.raises(ResultsError) as error:
            list(read_rows(path))
        assert str(error.value) == f"{path}: cannot be read as rows: {why}; name another folder"


@pytest.mark.parametrize("line", ["[1]", "1", "{", "[" * 100_000])
def test_line_that_is_no_row_is_named(tmp_path: Path, line: str):
    (tmp_path / "a.jsonl").write_text('{"a": 1}\n\n' + line + "\n")
    with pytest.raises(ResultsError, match=r"a\.jsonl:3: "):
        list(read_rows(tmp_path / "a.jsonl"))
