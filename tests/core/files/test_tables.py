"""If one of these fails, a table that a spreadsheet or a mail program saved anew is read with other numbers."""

from collections.abc import Callable
from pathlib import Path

import pytest

from tangible_core.files.tables import read_table

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
