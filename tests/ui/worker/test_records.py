"""Recordings: otherwise ticks of a touch are lost, or another touch is shown."""

import errno
import os
import stat
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tangible_core import HapticSurface, load_method
from tangible_core.data import TICK_COLUMNS
from tangible_core.servo import Servo
from tangible_core.session import About, Recording, Writer
from tangible_ui.feeling.recorder import BY_HAND, Recorder
from tangible_ui.worker.jobs import records
from tangible_ui.worker.state import WorkerState
from tangible_web.framing import FLAG_BITS
from waiting import LONGEST_S, until


@pytest.fixture
def servo(loop_in_thread: None) -> Any:
    surface = HapticSurface.from_heights(np.zeros((8, 8), np.float32))
    touch = load_method("render", "penalty")().touch(surface)
    with Servo(touch, load_method("device", "mock")(), seconds=LONGEST_S) as running:
        yield running


def some(ticks: int, force_n: float = 1.0) -> Recording:
    rows = np.zeros((ticks, len(TICK_COLUMNS)))
    rows[:, 0] = 1e6 + np.arange(ticks) / 1000
    rows[:, 2] = np.linspace(-0.01, 0.01, ticks)
    rows[:, 4] = -0.001
    rows[:, 13] = force_n
    return Recording(rows, "", About("mock", "penalty", "scene: builtin/brick\n"))


def wait_for_ticks(servo: Servo, ticks: int) -> None:
    """Wait for this many ticks more."""
    before = servo.ring.count
    until(lambda: servo.ring.count >= before + ticks)


class TestRecorder:
    def test_recorder_keeps_every_tick_once(self, servo: Servo, tmp_path: Path) -> None:
        ended: list[tuple[Path, int, str]] = []
        recorder = Recorder(servo, tmp_path / "mine" / "a.nc", About(), lambda *told: ended.append(told))
        modes = [stat.S_IMODE(each.stat().st_mode) for each in (recorder.path.parent, recorder.path)]
        assert modes == [0o700, 0o600]
        wait_for_ticks(servo, 1)
        first_s = servo.ring.since(servo.ring.count - 1)[0][-1, 0]
        wait_for_ticks(servo, 300)
        recorder.stop()
        found = Recording.load(recorder.path)
        assert ended == [(recorder.path, len(found.rows), BY_HAND)]
        assert found.stopped == ""
        assert len(found.rows) >= 250
        steps = np.diff(found.time_s)
        assert steps.min() > 0
        assert servo.running
        assert found.time_s[0] <= first_s

    def test_recorder_ends_with_its_loop(self, servo: Servo, tmp_path: Path) -> None:
        recorder = Recorder(servo, tmp_path / "a.nc", About(), lambda *told: None)
        wait_for_ticks(servo, 100)
        servo.stop("the device was pulled out")
        recorder._thread.join(LONGEST_S)  # pyright: ignore[reportPrivateUsage]
        found = Recording.load(tmp_path / "a.nc")
        assert found.stopped == "the device was pulled out"
        assert len(found.rows) >= 50

    def test_recorder_on_a_full_disk_ends_and_the_loop_goes_on(
        self, servo: Servo, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        ended: list[str] = []
        recorder = Recorder(servo, tmp_path / "a.nc", About(), lambda path, ticks, why: ended.append(why))

        def full(writer: Writer, data: bytes, at: int) -> None:
            raise OSError(errno.ENOSPC, "No space left on device")

        monkeypatch.setattr(Writer, "_put", full)
        recorder._thread.join(LONGEST_S)  # pyright: ignore[reportPrivateUsage]
        assert len(ended) == 1
        assert "free some space" in ended[0]
        assert servo.running


class TestShown:
    def test_shown_recording_of_an_old_clock_keeps_its_times(self, worker_state: WorkerState, tmp_path: Path) -> None:
        some(50).save(tmp_path / "a.nc")
        shown = records.show_record(worker_state, str(tmp_path / "a.nc"))
        rows = np.fromfile(tmp_path / shown["digest"] / "ticks.f32", "<f4").reshape(shown["rows"], shown["columns"])
        assert np.allclose(rows[:, 0], np.arange(50) / 1000, atol=1e-6)
        assert np.allclose(rows[:, 2], some(50).position_m[:, 0], atol=1e-8)
        assert (shown["every"], shown["law"], shown["stopped"]) == (1, "penalty", "")

    def test_shown_recording_that_is_long_is_thinned(
        self, worker_state: WorkerState, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        monkeypatch.setattr(records, "MAX_ROWS", 20)
        long, flags = some(50), np.arange(50) % 8 + 8 * (FLAG_BITS + 1)  # with some of a later version
        rows = long.rows.copy()
        rows[:, records.AT_FLAGS] = flags
        Recording(rows, "", long.about).save(tmp_path / "a.nc")
        shown = records.show_record(worker_state, str(tmp_path / "a.nc"))
        assert (shown["rows"], shown["every"]) == (17, 3)
        for ticks, every in ((0, 1), (20, 1), (21, 2), (41, 3)):
            some(ticks).save(tmp_path / f"{ticks}.nc")
            assert records.show_record(worker_state, str(tmp_path / f"{ticks}.nc"))["every"] == every
        rows = np.fromfile(tmp_path / shown["digest"] / "ticks.f32", "<f4").reshape(17, shown["columns"])
        np.testing.assert_array_equal(rows[:, records.AT_FLAGS], flags[::3] & FLAG_BITS)

    def test_list_of_recordings_has_the_newest_first_and_unreadable_ones(
        self, worker_state: WorkerState, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        monkeypatch.setenv("TANGIBLE_DATA_DIR", str(tmp_path))
        assert records.records(worker_state) == []
        some(5).save(tmp_path / "recordings/old.nc")
        os.utime(tmp_path / "recordings/old.nc", (0, 0))
        (tmp_path / "recordings/broken.nc").write_bytes(b"CDF nothing")
        found = records.records(worker_state)
        assert [each["name"] for each in found] == ["broken.nc", "old.nc"]
        assert found[0]["trouble"] and found[1]["figures"]["ticks"] == 5
        monkeypatch.setattr(records, "MAX_LISTED", 1)
        assert [record["name"] for record in records.records(worker_state)] == ["broken.nc"]


def test_two_recordings_are_compared_place_by_place(worker_state: WorkerState, tmp_path: Path) -> None:
    some(50, 1.0).save(tmp_path / "a.nc")
    some(80, 1.5).save(tmp_path / "b.nc")
    found = records.compare_records(worker_state, str(tmp_path / "a.nc"), str(tmp_path / "b.nc"))
    assert found["error_n"] == pytest.approx(0.5)
    assert (found["first_peak_force_n"], found["second_peak_force_n"]) == (1.0, 1.5)


def test_replay_with_another_law_uses_the_same_states(
    worker_state: WorkerState, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("TANGIBLE_DATA_DIR", str(tmp_path))
    np.save(tmp_path / "flat.npy", np.zeros((8, 8)))
    text = (
        "scene: {height: flat.npy}\nwant: touch\nrender: {use: penalty, stiffness_n_per_m: 500}\n"
        "workspace: {relief_m: 0.001, smooth_m: 0}\n"
    )
    some(50).save(tmp_path / "a.nc")
    shown = records.try_law(worker_state, text, tmp_path / "p.yaml", [], tmp_path / "a.nc")
    after = Recording.load(shown["path"])
    assert Path(shown["path"]).name == "a with penalty.nc"
    again = records.try_law(worker_state, text, tmp_path / "p.yaml", [], tmp_path / "a.nc")
    assert Path(again["path"]).name == "a with penalty 1.nc"
    assert np.allclose(after.force_n[1:-1, 2], 0.5, atol=0.05)
    assert shown["compared"]["worst_error_n"] == pytest.approx(0.5, abs=0.05)
