"""The ring that a force loop shares: its layout, what a reader gets of it, and what becomes of the file."""

import os
import threading
from pathlib import Path

import numpy as np
import pytest

from tangible_core.data import TICK_COLUMNS
from tangible_core.errors import DeviceError
from tangible_core.servo import Ring, cycle, ring
from tangible_core.servo.loop import sections
from tangible_core.servo.reports import report, spread
from tangible_core.servo.ring import COUNT, SLOTS, shared_folder


@pytest.fixture
def small():
    made = Ring.create(16)
    yield made
    made.remove()


def put(into: Ring, *numbers: int) -> None:
    """Ticks of which every number is the tick's own; the flags are none."""
    for number in numbers:
        row = np.full(len(TICK_COLUMNS), float(number))
        row[cycle.FLAGS] = 0
        cycle.finish(sections(into), row, number * 1_000_000, 2000 * number)


class TestReading:
    def test_all_of_it_then_only_what_is_new(self, small: Ring) -> None:
        put(small, *range(5))
        rows, following = small.since(0)
        assert (rows[:, 0].tolist(), following) == ([0, 1, 2, 3, 4], 5)
        put(small, 5, 6)
        rows, following = small.since(following)
        assert (rows[:, 0].tolist(), following) == ([5, 6], 7)
        assert small.since(following)[0].shape == (0, len(TICK_COLUMNS))

    def test_what_was_overwritten_is_missing_and_can_be_counted(self, small: Ring) -> None:
        put(small, *range(40))
        rows, following = small.since(10)
        assert rows[:, 0].tolist() == list(range(24, 40))
        assert following - 10 - len(rows) == 14

    def test_a_slot_being_written_is_not_read(self, small: Ring) -> None:
        put(small, *range(5))
        small.stamps[3] = -1
        assert small.since(0)[0][:, 0].tolist() == [0, 1, 2, 4]

    def test_no_torn_row_while_a_loop_writes_as_fast_as_it_can(self, small: Ring) -> None:
        done = threading.Event()

        def write() -> None:
            put(small, *range(30_000))
            done.set()

        thread = threading.Thread(target=write)
        thread.start()
        first, seen = 0, 0
        while not done.is_set():
            rows, first = small.since(first)
            whole = np.delete(rows, cycle.FLAGS, axis=1)
            assert (whole == whole[:, :1]).all()
            assert (np.diff(whole[:, 0]) > 0).all()
            seen += len(rows)
        thread.join()
        assert seen > 0


class TestFile:
    def test_another_process_finds_the_same(self, small: Ring) -> None:
        put(small, 0, 1)
        other = Ring.attach(small.path)
        assert other.header[COUNT] == 2
        assert other.header[SLOTS] == 16
        np.testing.assert_array_equal(other.since(0)[0], small.since(0)[0])

    def test_sections_are_where_the_table_says(self, small: Ring) -> None:
        """By the documented layout alone, as a reader in another language finds them."""
        put(small, 0, 7)
        data = small.path.read_bytes()
        at = 8 * (64 + 64 + 128 + 4096 + 4096)
        assert np.frombuffer(data, np.int64, 2, at).tolist() == [0, 1]
        ticks = np.frombuffer(data, np.float64, 16 * len(TICK_COLUMNS), at + 16 * 8).reshape(16, -1)
        assert ticks[1, 0] == 7

    @pytest.mark.parametrize("content", [b"", b"x" * 100, bytes(100_000)])
    def test_what_is_no_ring_is_refused(self, tmp_path: Path, content: bytes) -> None:
        (tmp_path / "x.ring").write_bytes(content)
        with pytest.raises(DeviceError, match=r"x\.ring"):
            Ring.attach(tmp_path / "x.ring")

    def test_none_there(self, tmp_path: Path) -> None:
        with pytest.raises(DeviceError, match="no force loop runs there"):
            Ring.attach(tmp_path / "none.ring")

    def test_no_room(self, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
        monkeypatch.setattr(ring, "shared_folder", lambda: tmp_path / "missing")
        with pytest.raises(DeviceError, match="no room"):
            Ring.create()

    def test_what_killed_processes_left_is_swept_away(self) -> None:
        dead = shared_folder() / "tangible-999999999-x.ring"
        mine = shared_folder() / f"tangible-{os.getpid()}-x.ring"
        dead.touch()
        mine.touch()
        Ring.create(16).remove()
        try:
            assert not dead.exists()
            assert mine.exists()
        finally:
            mine.unlink()

    def test_only_files_of_ones_own_are_swept_and_odd_ones_harm_nobody(self, tmp_path: Path, monkeypatch) -> None:
        """Names that are none of ours, a folder, a link, a file that cannot be removed, and one of another user."""
        monkeypatch.setattr(ring, "shared_folder", lambda: tmp_path)
        odd = [
            "tangible-²-x.ring",
            "tangible-99999999999999999999-x.ring",
            "tangible-999999999-x.txt",
            "tangible--.ring",
        ]
        for name in odd:
            (tmp_path / name).touch()
        (tmp_path / "tangible-999999998-x.ring").mkdir()
        (tmp_path / "kept").touch()
        (tmp_path / "tangible-999999997-x.ring").symlink_to(tmp_path / "kept")
        (tmp_path / "tangible-999999996-x.parcel").touch()
        stays = {*odd, "tangible-999999998-x.ring", "tangible-999999997-x.ring", "kept"}
        Ring.create(16).remove()
        assert {path.name for path in tmp_path.iterdir()} == stays

        theirs = tmp_path / "tangible-999999995-x.ring"
        theirs.touch()
        with monkeypatch.context() as another:
            another.setattr(os, "getuid", lambda: 12345)
            Ring.create(16).remove()
        assert theirs.exists()

        def refused(path: Path, missing_ok: bool = False) -> None:
            raise PermissionError(1, "not permitted", str(path))

        with monkeypatch.context() as sticky:
            sticky.setattr(Path, "unlink", refused)
            made = Ring.create(16)
        assert theirs.exists()
        made.remove()

    def test_the_table_in_the_documentation_is_the_layout(self) -> None:
        """Name, type and shape of each section, for readers in other languages."""
        types = {np.int64: "int64", np.float64: "float64"}
        for name, (kind, shape) in ring._sections(12345).items():
            said = ", ".join(map(str, shape)).replace("12345", "n") + ("," if len(shape) == 1 else "")
            assert f"| {name} | {types[kind]} ({said}) |" in (ring.__doc__ or "")


class TestReport:
    def test_of_an_empty_ring(self, small: Ring) -> None:
        assert report(small).ticks == 0

    def test_sums(self, small: Ring) -> None:
        """Force and position are (k, k, k) at tick k: the work is that of each force over the way to the next tick."""
        put(small, *range(20))
        found = report(small, "over")
        assert (found.ticks, found.stopped, found.overruns) == (20, "over", 0)
        assert found.peak_force_n == pytest.approx(19 * np.sqrt(3))
        assert found.work_j == pytest.approx(3 * sum(range(19)))
        assert found.period_us == (1000, 1000, 1000, 1000)
        assert found.late_us == (18, 38, 38, 38)

    def test_quantiles(self) -> None:
        counts = np.zeros(100, np.int64)
        counts[[10, 20, 30, 40]] = 989, 10, 1, 0
        assert spread(counts, 31e-6) == (10, 20, 20, 31)
