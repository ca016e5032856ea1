"""Recordings in memory and in their files: ticks that were recorded come back, or their loss is said."""

import csv
import os
import tracemalloc
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.lib import recfunctions as rfn
from scipy.io import netcdf_file

from hostile import npz_bomb
from tangible_core.data import TICK_COLUMNS, TickFlag
from tangible_core.errors import OutputError
from tangible_core.session import About, Recording, check_record_path
from tangible_core.session.recording import netcdf, tick_file

ABOUT = About("mock", "proxy", "scene: x\nwörds: 1\n", "2026-01-02T03:04:05+00:00", "mine 1.0")


def some(count: int = 5, **more) -> Recording:
    """A recording of numbers that float32 holds."""
    rows = np.random.default_rng(1).normal(size=(count, 17)).astype(np.float32).astype(float)
    rows[:, 0] = 1e5 + np.arange(count) * 0.001
    rows[:, 14:] = np.arange(3 * count).reshape(count, 3)
    rows[2:, 16] = np.nan  # from the third tick on, another surface, that stands still
    rows[1:, 8:11] = np.nan
    return Recording(rows, **more)


@pytest.mark.parametrize("suffix", [".nc", ".npz"])
@pytest.mark.parametrize("count", [0, 1, 5])
def test_saved_recording_is_loaded_unchanged(tmp_path: Path, count: int, suffix: str):
    recording = some(count, stopped="the cable is out", about=ABOUT)
    recording.save(tmp_path / "deep" / f"stroke{suffix}")
    assert Recording.load(tmp_path / "deep" / f"stroke{suffix}").digest() == recording.digest()


@pytest.mark.parametrize("count", [0, 1, 5])
def test_csv_keeps_every_digit_of_the_ticks(tmp_path: Path, count: int):
    recording = Recording(some(count).rows + np.pi)
    recording.save(tmp_path / "stroke.csv")
    assert Recording.load(tmp_path / "stroke.csv").digest() == recording.digest()
    with (tmp_path / "stroke.csv").open(newline="") as file:
        assert [float(row["fz_n"]) for row in csv.DictReader(file)] == recording.force_n[:, 2].tolist()


def test_csv_is_read_by_its_column_names(tmp_path: Path):
    names = [name for name in TICK_COLUMNS if not name.startswith(("proxy", "late", "flags", "buttons", "frame"))]
    (tmp_path / "old.csv").write_text(
        "\ufeff" + ",".join(["note", *reversed(names)]) + "\n" + "9,9,8,7,6,5,4,3,2,1,0\n" * 2
    )
    recording = Recording.load(tmp_path / "old.csv")
    assert recording.time_s.tolist() == [0, 0]
    assert (recording.position_m[0].tolist(), recording.force_n[1].tolist()) == ([1, 2, 3], [7, 8, 9])
    assert np.isnan(recording.proxy_m).all() and np.isnan(recording.frame).all()
    assert not (recording.late_s.any() or recording.flags.any() or recording.buttons.any())


@pytest.mark.parametrize("suffix", [".nc", ".npz"])
def test_old_file_without_frames_is_read(tmp_path: Path, suffix: str):
    before = some()
    path = tmp_path / f"old{suffix}"
    if suffix == ".nc":
        names = TICK_COLUMNS[:-1]
        head = netcdf.header("tick", {"stopped": ""}, {name: tick_file.VARIABLES[name] for name in names}, 5)
        ticks = np.frombuffer(tick_file.pack(before.rows), tick_file.RECORD)
        path.write_bytes(head + rfn.repack_fields(ticks[list(names)]).tobytes())
    else:
        before.save(tmp_path / "new.npz")
        with np.load(tmp_path / "new.npz") as new:
            np.savez(path, **{name: new[name] for name in new.files if name != "frame"})
    found = Recording.load(path)
    assert np.array_equal(found.rows[:, :-1], before.rows[:, :-1], equal_nan=True)
    assert np.isnan(found.frame).all()


def test_nc_and_old_npz_files_are_read(tmp_path: Path):
    """Frame numbers beyond float32, and invalid ones."""
    rows = some().rows.copy()
    rows[:, 16] = 0, 2**24 + 1, np.nan, np.inf, -7
    Recording(rows).save(tmp_path / "stroke.nc")
    with netcdf_file(tmp_path / "stroke.nc", mmap=False, maskandscale=True) as file:
        assert file.variables["frame"][:].tolist() == [0, 2**24 + 1, None, None, None]
    assert np.array_equal(Recording.load(tmp_path / "stroke.nc").frame[:2], rows[:2, 16])
    arrays = {name: getattr(some(), name) for name in ("time_s", "position_m", "velocity_m_per_s", "force_n")}
    np.savez(tmp_path / "old.npz", **arrays, stopped="", not_finite=2, limited=3)
    recording = Recording.load(tmp_path / "old.npz")
    assert all(np.array_equal(getattr(recording, name), array) for name, array in arrays.items())
    assert np.isnan(recording.proxy_m).all()
    assert recording.about == About()


def test_figures_of_a_recording_are_exact_and_its_shape_is_checked():
    force = np.array([[0, 0, 0], [0, 3, 4], [0, 0, 1], [0, 0, 0]], float)
    position = np.array([[0, 0, 0], [0, 0, 0], [0, 1, 1], [0, 1, 3]], float)
    flags = np.array([0, TickFlag.FORCE_LIMITED | TickFlag.TOUCHING, TickFlag.NOT_FINITE, TickFlag.NOT_FINITE])
    recording = Recording.of(
        time_s=np.arange(4.0), position_m=position, velocity_m_per_s=np.zeros((4, 3)), force_n=force, flags=flags
    )
    assert recording.figures() == {
        "ticks": 4,
        "seconds": 3.0,
        "contact_share": 0.5,
        "median_contact_force_n": 3.0,
        "peak_force_n": 5.0,
        "work_j": 7.0 + 2.0,
        "force_limited": 1,
        "not_finite": 2,
    }
    with pytest.raises(OutputError, match=r"\(n, 17\)"):
        Recording(np.zeros((3, 10)))
    parts = {"time_s": np.zeros(3), "position_m": np.zeros((3, 3)), "velocity_m_per_s": np.zeros((3, 3))}
    with pytest.raises(OutputError, match=r"force_n has shape \(1, 3\); with these times it must be \(3, 3\)"):
        Recording.of(**parts, force_n=np.zeros((1, 3)))


def refusal(path: Path) -> str:
    with pytest.raises(OutputError) as error:
        Recording.load(path)
    assert str(error.value).startswith(f"{path}: ")
    return str(error.value)


@pytest.mark.parametrize("suffix", [".nc", ".npz", ".csv"])
def test_recording_above_the_size_limit_is_refused(tmp_path: Path, suffix: str):
    with (tmp_path / f"a{suffix}").open("wb") as file:
        file.truncate(1_500_000_000)
    assert "cannot be read: it holds more than 1424 MB" in refusal(tmp_path / f"a{suffix}")


def test_decompression_bomb_is_not_unpacked(tmp_path: Path):
    ticks = 12_000_000
    shapes = {"time_s": (ticks,), "position_m": (ticks, 3), "velocity_m_per_s": (ticks, 3), "force_n": (ticks, 10)}
    path = npz_bomb(tmp_path / "a.npz", **shapes)
    tracemalloc.start()
    try:
        assert "holds more than 1424 MB" in refusal(path)
        assert tracemalloc.get_traced_memory()[1] < 1e8
    finally:
        tracemalloc.stop()


def test_archive_is_read_by_its_needed_entries_alone(tmp_path: Path):
    np.savez(tmp_path / "a.npz", time_s=np.zeros(3), stopped="")
    assert "it holds no position_m, velocity_m_per_s, force_n" in refusal(tmp_path / "a.npz")
    some().save(tmp_path / "a.npz")
    with np.load(tmp_path / "a.npz") as held:
        np.savez(tmp_path / "b.npz", **{name: held[name] for name in held if name != "stopped"})
    assert "it holds no stopped" in refusal(tmp_path / "b.npz")
    some().save(tmp_path / "a.npz")
    with np.load(tmp_path / "a.npz") as held:
        np.savez(tmp_path / "b.npz", **held, more=np.array([{}], object))
    assert Recording.load(tmp_path / "b.npz").digest() == some().digest()


@pytest.mark.parametrize("dtype", [complex, "U1", "M8[s]"])
def test_ticks_that_are_not_numbers_are_refused(tmp_path: Path, dtype: object):
    some().save(tmp_path / "a.npz")
    with np.load(tmp_path / "a.npz") as held:
        np.savez(tmp_path / "b.npz", **{**held, "late_s": np.zeros(5, dtype)})
    assert "late_s holds" in refusal(tmp_path / "b.npz")


@pytest.mark.parametrize(("place", "bits"), [(14, "nan"), (14, "1e300"), (15, "inf"), (15, "-3e9")])
def test_flags_and_buttons_beyond_32_bits_are_refused(tmp_path: Path, bits: str, place: int):
    row = ["0"] * 17
    row[place] = bits
    (tmp_path / "a.csv").write_text(f"{','.join(TICK_COLUMNS)}\n{','.join(row)}\n")
    assert f"its {TICK_COLUMNS[place]} do not all fit into 32 bits" in refusal(tmp_path / "a.csv")


def test_csv_without_needed_columns_or_numbers_is_refused(tmp_path: Path):
    for name in ("time_s", "fz_n"):
        (tmp_path / "less.csv").write_text(",".join(each for each in TICK_COLUMNS if each != name) + "\n")
        assert f"first line has no {name}" in refusal(tmp_path / "less.csv")
    (tmp_path / "text.csv").write_text(f"{','.join(TICK_COLUMNS)}\n" + "x" + ",0" * 16 + "\n")
    assert "is not a recording" in refusal(tmp_path / "text.csv")


@pytest.mark.parametrize("suffix", [".nc", ".npz", ".csv"])
@given(data=st.data())
def test_damaged_file_is_one_error_or_a_recording(tmp_path_factory, suffix: str, data):
    path = tmp_path_factory.mktemp("damaged") / f"a{suffix}"
    some(about=ABOUT).save(path)
    damaged = bytearray(path.read_bytes())
    for place in data.draw(st.lists(st.integers(0, len(damaged) - 1), min_size=1, max_size=4)):
        damaged[place] = data.draw(st.integers(0, 255))
    path.write_bytes(damaged)
    try:
        assert Recording.load(path).flags.dtype == np.int64
    except OutputError as error:
        assert str(error).startswith(f"{path}: ")
        assert str(error).isprintable()


@pytest.mark.parametrize("name", ["stroke", "stroke.npz.txt"])
def test_recording_name_with_wrong_suffix_is_refused(tmp_path: Path, name: str):
    with pytest.raises(OutputError, match=r"\.nc, \.npz or \.csv"):
        check_record_path(tmp_path / name)
    with pytest.raises(OutputError, match=r"\.nc, \.npz or \.csv"):
        some().save(tmp_path / name)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("suffix", [".nc", ".npz"])
def test_truncated_recording_is_refused(tmp_path: Path, suffix: str):
    some(2).save(tmp_path / f"whole{suffix}")
    data = (tmp_path / f"whole{suffix}").read_bytes()
    path = tmp_path / f"cut{suffix}"
    for length in range(0, len(data), 7):
        path.write_bytes(data[:length])
        with pytest.raises(OutputError, match="is not a recording, or a damaged one"):
            Recording.load(path)


def test_file_of_another_kind_is_refused(tmp_path: Path):
    np.savez(tmp_path / "other.npz", picture=np.zeros(3))
    np.save(tmp_path / "array.npy", np.zeros(3))
    (tmp_path / "array.npy").rename(tmp_path / "array.npz")
    with netcdf_file(tmp_path / "other.nc", "w") as file:
        file.createDimension("x", 3)
        file.createVariable("time_s", "d", ("x",))[:] = 0
    for name in ("empty.csv", "bytes.csv"):
        (tmp_path / name).write_bytes(b"" if name == "empty.csv" else b"\xff" * 99)
    for name in ("other.npz", "array.npz", "other.nc", "empty.csv", "bytes.csv"):
        assert "is not a recording" in refusal(tmp_path / name)


@pytest.mark.timeout(20)
@pytest.mark.parametrize("suffix", [".nc", ".npz", ".csv"])
def test_missing_file_folder_pipe_or_device_is_refused(tmp_path: Path, suffix: str):
    (tmp_path / f"folder{suffix}").mkdir()
    os.mkfifo(tmp_path / f"pipe{suffix}")
    (tmp_path / f"zero{suffix}").symlink_to("/dev/zero")
    assert "there is no such file" in refusal(tmp_path / f"none{suffix}")
    for name in ("folder", "pipe", "zero"):
        assert "cannot be read" in refusal(tmp_path / f"{name}{suffix}")
