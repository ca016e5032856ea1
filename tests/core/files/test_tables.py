"""Tables of ours, and the same tables as spreadsheets and mail programs save them anew."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from tangible_core.data import TICK_COLUMNS
from tangible_core.errors import DeviceError, OutputError, ResultsError
from tangible_core.files.tables import read_table
from tangible_core.session.recording import files as recordings
from tangible_core.session.recording.tick_arrays import unknown_rows
from tangible_devices.paths import read_csv
from tangible_study.trials import Answer, AnswerFile, read_answers

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


@pytest.fixture
def recording() -> np.ndarray:
    rows = unknown_rows(3)
    rows[:, [TICK_COLUMNS.index(name) for name in ("time_s", "x_m")]] = [[0, 0.0125], [0.001, -1.5e-7], [0.002, 3]]
    rows[np.isnan(rows)] = 0.0
    return rows


@pytest.mark.parametrize("change", ["German", "mail", "byte-order mark", "quoted"])
def test_recording_from_a_spreadsheet_has_the_same_numbers(tmp_path: Path, recording: np.ndarray, change: str):
    recordings.write(tmp_path / "a.csv", recordings.RecordingContents(recording))
    lines = [line.split(",") for line in (tmp_path / "a.csv").read_text().splitlines()]
    (tmp_path / "a.csv").write_bytes(SAVED[change](lines))
    assert np.array_equal(recordings.read(tmp_path / "a.csv").rows, recording)


def test_number_that_a_spreadsheet_made_a_date_names_its_line_and_column(tmp_path: Path, recording: np.ndarray):
    recordings.write(tmp_path / "a.csv", recordings.RecordingContents(recording))
    text = (tmp_path / "a.csv").read_text()
    (tmp_path / "a.csv").write_text(text.replace("0.012500000000000001", "12. Mai"))
    with pytest.raises(OutputError, match=r"in line 2, x_m is not a number: .*'12. Mai'"):
        recordings.read(tmp_path / "a.csv")


@pytest.mark.parametrize("change", SAVED)
def test_stroke_from_a_spreadsheet_is_the_same(tmp_path: Path, change: str):
    lines = [["time_s", "x_m", "y_m", "z_m"], ["0", "0", "0.5", "-0.01"], ["0.5", "0.02", "0", "1e-3"]]
    (tmp_path / "a.csv").write_bytes(SAVED[change](lines))
    stroke = read_csv(tmp_path / "a.csv", 0.001)
    assert stroke.times_s == (0.0, 0.5)
    assert stroke.points_m == ((0.0, 0.5, -0.01), (0.02, 0.0, 0.001))


def test_stroke_with_a_quote_that_does_not_end_is_refused(tmp_path: Path):
    (tmp_path / "a.csv").write_text('time_s,x_m,y_m,z_m\n0,0,0,0\n1,0,0,"0\n2,0,0,0\n')
    with pytest.raises(DeviceError, match="correct its quotes"):
        read_csv(tmp_path / "a.csv", 0.001)


ANSWER = Answer(1, "test", "a", "higher", "constant", "one", None, 0.0015, 0.002, 2, "2", 1, None, 1.25, target="Öl")


@pytest.mark.parametrize("change", ["German", "mail", "old line ends", "byte-order mark", "quoted"])
def test_answers_from_a_spreadsheet_are_the_same(tmp_path: Path, change: str):
    with AnswerFile(tmp_path / "a.tsv") as table:
        table.add(ANSWER)
        table.add(ANSWER)
    lines = [line.split("\t") for line in (tmp_path / "a.tsv").read_text(encoding="utf-8").splitlines()]
    upper = [[cell.upper() if cell in ("true", "false") else cell for cell in line] for line in lines]
    (tmp_path / "a.tsv").write_bytes(SAVED[change](upper))
    assert read_answers(tmp_path / "a.tsv") == [ANSWER, ANSWER]


def test_last_answer_without_an_end_is_left_out_and_told(tmp_path: Path, caplog: pytest.LogCaptureFixture):
    with AnswerFile(tmp_path / "a.tsv") as table:
        table.add(ANSWER)
        table.add(ANSWER)
    (tmp_path / "a.tsv").write_bytes((tmp_path / "a.tsv").read_bytes()[:-1])
    assert read_answers(tmp_path / "a.tsv") == [ANSWER]
    assert "its last line has no end, and is left out" in caplog.text


def test_answer_that_is_a_date_names_its_line(tmp_path: Path):
    with AnswerFile(tmp_path / "a.tsv") as table:
        table.add(ANSWER)
    (tmp_path / "a.tsv").write_text((tmp_path / "a.tsv").read_text().replace("0.0015", "15. Jan"))
    with pytest.raises(ResultsError, match=r"a\.tsv:2: is not an answer: could not convert string to float: '15. Jan'"):
        read_answers(tmp_path / "a.tsv")
