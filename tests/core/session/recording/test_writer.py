"""Growing recordings: if they fail, ticks that a hand felt are lost when a program ends or a disk is full."""

import subprocess
import sys
import textwrap
from io import BytesIO, FileIO
from pathlib import Path

import numpy as np
import pytest
from scipy.io import netcdf_file

from full_disk import files_up_to
from tangible_core.data import TICK_COLUMNS
from tangible_core.errors import OutputError
from tangible_core.session import About, Recording, Writer
from tangible_core.session.recording import netcdf, tick_file

ROWS = np.arange(17 * 50, dtype=float).reshape(50, 17)


def start(code: str, *words: object) -> subprocess.Popen[str]:
    """Start a program that writes a recording, with these words as its arguments."""
    head = "import sys, numpy as np; from pathlib import Path; from tangible_core.session import Writer\n"
    command = [sys.executable, "-c", head + textwrap.dedent(code), *map(str, words)]
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def test_writer_makes_appended_ticks_readable_at_once(tmp_path: Path):
    path = tmp_path / "deep" / "stroke.nc"
    with Writer(path, About("mock", "proxy", "want: touch\n")) as writer:
        for end in (0, 1, 20, 20, 50):
            writer.append(ROWS[writer.ticks : end])
            recording = Recording.load(path)
            assert np.array_equal(recording.rows, ROWS[:end])
            assert recording.stopped == "cut off: the recorder was ended before it could close the file"
    closed = Recording.load(path)
    about = closed.about
    assert closed.stopped == ""
    assert (about.device, about.renderer, about.configuration) == ("mock", "proxy", "want: touch\n")
    assert about.started.startswith("20")
    assert "tangible-images" in about.software


def test_file_has_names_units_flags_and_offsets_for_other_programs(tmp_path: Path):
    with Writer(tmp_path / "stroke.nc", About("falcon")) as writer:
        writer.append(ROWS)
    with netcdf_file(tmp_path / "stroke.nc", mmap=False) as file:
        assert tuple(file.variables) == TICK_COLUMNS
        assert file.device == b"falcon"
        units = [file.variables[name].units.decode() for name in ("time_s", "x_m", "vy_m_per_s", "fz_n")]
        assert units == ["s", "m", "m s-1", "N"]
        flags = file.variables["flags"]
        assert dict(zip(flags.flag_meanings.decode().split(), flags.flag_masks, strict=True))["force_limited"] == 2
        assert np.array_equal(file.variables["fz_n"][:], ROWS[:, 13])
    head = tick_file.header(About())
    following = [head.rindex(netcdf.integer(len(name)) + name.encode()) for name in TICK_COLUMNS[1:]] + [len(head)]
    begins = [int.from_bytes(head[at - 8 : at], "big") for at in following]
    assert begins == [len(head) + tick_file.RECORD.fields[name][1] for name in TICK_COLUMNS]


def test_ticks_take_96_bytes_and_the_reason_of_the_end_is_stored(tmp_path: Path):
    """Inputs of a law are exact, even after ten days; proxies are within 4 nm, forces within 0.3 uN."""
    rows = np.random.default_rng(0).uniform(-1, 1, (1000, 17)) * ([0.01, 1e-3] + [0.125] * 9 + [8] * 3 + [0, 0, 0])
    rows[:, 0] += 864_000
    rows[0, 11:14] = 1e300, np.nan, -np.inf
    path = tmp_path / "stroke.nc"
    with Writer(path) as writer:
        empty = path.stat().st_size
        writer.append(rows)
        assert path.stat().st_size - empty == 96 * 1000
    found = Recording.load(path).rows
    assert np.array_equal(found[0, 11:14], [np.inf, np.nan, -np.inf], equal_nan=True), "beyond float32"
    lost = np.abs(found[1:] - rows[1:]).max(axis=0)
    assert not lost[[0, 2, 3, 4, 5, 6, 7]].any()
    assert lost[8:11].max() < 4e-9
    assert lost[11:14].max() < 3e-7
    writer = Writer(path)
    writer.close("é" * 200)
    writer.close("again")
    assert Recording.load(path).stopped == "é" * 120
    Writer(path).close("a" + "é" * 200)  # the last letter that would fit is half a one
    assert Recording.load(path).stopped == "a" + "é" * 119
    with pytest.raises(OutputError, match="is closed"):
        writer.append(ROWS)
    with pytest.raises(ZeroDivisionError), Writer(path):
        raise ZeroDivisionError("oh")
    assert Recording.load(path).stopped == "ZeroDivisionError: oh"


@pytest.mark.usefixtures("unchecked_shapes")
@pytest.mark.parametrize("rows", [np.zeros(17), np.zeros((3, 10))])
def test_rows_of_wrong_shape_are_refused(tmp_path: Path, rows: np.ndarray):
    with Writer(tmp_path / "stroke.nc") as writer, pytest.raises(OutputError, match=r"\(n, 17\)"):
        writer.append(rows)


def test_second_writer_of_a_file_is_refused(tmp_path: Path):
    path = tmp_path / "stroke.nc"
    with Writer(path) as writer:
        writer.append(ROWS)
        with pytest.raises(OutputError, match="another program is writing to it"):
            Writer(path)
        other = start("Writer(Path(sys.argv[1]))", path)
        assert "OutputError" in other.communicate()[1].splitlines()[-1]
    assert np.array_equal(Recording.load(path).rows, ROWS)
    Writer(path).close()
    assert len(Recording.load(path).rows) == 0


def test_file_is_whole_between_and_within_writes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    writes: list[tuple[int, bytes]] = []

    class Noted(FileIO):
        def write(self, data: bytes) -> int:
            writes.append((self.tell(), bytes(data)))
            return super().write(data)

    monkeypatch.setattr(tick_file, "open_alone", lambda path, private: Noted(path, "w"))
    with Writer(tmp_path / "stroke.nc") as written:
        for end in (10, 11, 50):
            written.append(ROWS[written.ticks : end])
    assert len(writes) == 1 + 2 * 3 + 1
    for count in range(1, len(writes)):
        at, data = writes[count]
        for part in (0, 1, len(data) // 2, len(data) - 1) if len(data) > 4 else (0,):  # 4 bytes go in one piece
            after = BytesIO()
            for place, piece in [*writes[:count], (at, data[:part])]:
                after.seek(place)
                after.write(piece)
            (tmp_path / "cut.nc").write_bytes(after.getvalue())
            cut = Recording.load(tmp_path / "cut.nc")
            assert len(cut.rows) == (0, 0, 0, 10, 10, 11, 11, 50)[count]
            assert np.array_equal(cut.rows, ROWS[: len(cut.rows)])


def test_writer_on_full_disk_keeps_written_ticks(tmp_path: Path):
    path = tmp_path / "stroke.nc"
    writer = Writer(path)
    with files_up_to(20_000), pytest.raises(OutputError, match=r"cannot be written: .*; it holds 150 ticks; free some"):
        while True:
            writer.append(ROWS)
    assert writer.closed
    recording = Recording.load(path)
    assert np.array_equal(recording.rows, np.tile(ROWS, (3, 1)))
    assert recording.stopped.startswith("the recording ends early: ")


@pytest.mark.parametrize("most", [100, 120])
def test_writer_of_full_file_is_closed(tmp_path: Path, most: int, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(netcdf, "MAX_RECORDS", most)
    path = tmp_path / "stroke.nc"
    with Writer(path) as writer:
        writer.append(ROWS)
        writer.append(ROWS)
        with pytest.raises(OutputError, match="is full, with 100 ticks; start another one"):
            writer.append(ROWS)
    assert (len(Recording.load(path).rows), Recording.load(path).stopped) == (100, "the recording is full")
