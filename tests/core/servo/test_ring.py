"""The ring of a force loop: its layout, its readers, and its file."""

import os
import threading
from pathlib import Path

import numpy as np
import pytest

from tangible_core.data import TICK_COLUMNS, Force, HapticState, TickFlag
from tangible_core.errors import DeviceError
from tangible_core.servo import Ring, parcel, ring
from tangible_core.servo.guard.layout import COUNTS
from tangible_core.servo.reports import LoopTotals, report, spread
from tangible_core.servo.ring import (
    COUNT,
    IS_LAYOUT,
    IS_MAGIC,
    MARKS,
    MOST_LATE_S,
    OVERRUNS,
    PERIOD_NS,
    SLOTS,
    START_NS,
    WIDEST_US,
    shared_folder,
)
from tangible_core.servo.ticks import cycle
from tangible_core.servo.ticks.loop import sections
from tangible_core.session import Recording, figures


@pytest.fixture
def small():
    made = Ring.create(16)
    yield made
    made.remove()


def put(into: Ring, *numbers: int) -> None:
    """Write ticks whose values are all the number of the tick, without flags."""
    for number in numbers:
        row = np.full(len(TICK_COLUMNS), float(number))
        row[cycle.FLAGS] = 0
        cycle.finish(sections(into), row, number * 1_000_000, 2000 * number)


class Overwritten:
    """The ticks of a ring whose loop writes one more, over the oldest, while they are read: half before, half after."""

    def __init__(self, ring: Ring) -> None:
        self._ring, self._ticks = ring, ring.ticks

    def __getitem__(self, slots: np.ndarray) -> np.ndarray:
        torn = self._ticks[slots]
        self._ring.ticks = self._ticks
        put(self._ring, int(self._ring.header[COUNT]))
        half = torn.shape[1] // 2
        torn[:, half:] = self._ticks[slots][:, half:]
        return torn


class TestReading:
    def test_since_returns_all_ticks_then_only_new_ones(self, small: Ring) -> None:
        put(small, *range(5))
        rows, following = small.since(0)
        assert (rows[:, 0].tolist(), following) == ([0, 1, 2, 3, 4], 5)
        put(small, 5, 6)
        rows, following = small.since(following)
        assert (rows[:, 0].tolist(), following) == ([5, 6], 7)
        assert small.since(following)[0].shape == (0, len(TICK_COLUMNS))

    def test_since_omits_overwritten_ticks_and_returns_the_next_number(self, small: Ring) -> None:
        put(small, *range(40))
        rows, following = small.since(10)
        assert rows[:, 0].tolist() == list(range(24, 40))
        assert following - 10 - len(rows) == 14

    def test_slot_being_written_is_not_read(self, small: Ring) -> None:
        put(small, *range(5))
        small.stamps[3] = -1
        assert small.since(0)[0][:, 0].tolist() == [0, 1, 2, 4]

    def test_row_overwritten_during_the_read_is_omitted(self, small: Ring) -> None:
        put(small, *range(16))
        small.ticks = Overwritten(small)
        rows, following = small.since(0)
        whole = np.delete(rows, cycle.FLAGS, axis=1)
        assert whole.tolist() == [[number] * 16 for number in range(1, 16)]
        assert following == 16

    def test_ring_that_is_not_full_has_no_made_up_ticks(self, small: Ring) -> None:
        """The mark of a slot that is being written is not the number of a tick."""
        put(small, *range(15))
        small.stamps[15] = -1
        assert small.since(-1)[0][:, 0].tolist() == list(range(15))

    def test_rows_read_during_fast_writing_are_whole(self, small: Ring) -> None:
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


class Overtaken:
    """The ticks of a ring whose loop goes once round it, just after a row was copied or between its two halves."""

    def __init__(self, ring: Ring) -> None:
        self._ring, self._ticks = ring, ring.ticks

    def __getitem__(self, slot: int) -> np.ndarray:
        torn = self._ticks[slot].copy()
        self._ring.ticks = self._ticks
        put(self._ring, *range(self._ring.count, self._ring.count + 16))
        torn[8:] = self._ticks[slot, 8:]
        return torn


class TestLatest:
    def test_latest_is_the_newest_tick(self, small: Ring) -> None:
        small.stamps[-1] = -1  # the mark of a slot that is being written is no number of a tick
        assert small.latest() is None
        for number in range(40):
            put(small, number)
            row = small.latest()
            assert row is not None and row[0] == number
            assert small.count == number + 1

    def test_latest_is_a_copy(self, small: Ring) -> None:
        put(small, *range(3))
        row = small.latest()
        put(small, *range(3, 30))
        assert row is not None and np.delete(row, cycle.FLAGS).tolist() == [2] * 16

    def test_latest_overwritten_during_the_read_is_none(self, small: Ring) -> None:
        put(small, *range(20))
        small.ticks = Overtaken(small)
        assert small.latest() is None
        row = small.latest()
        assert row is not None and row[0] == 35

    def test_header_words_have_names(self, small: Ring) -> None:
        small.header[START_NS], small.header[OVERRUNS] = 7, 5
        assert (small.start_ns, small.overruns, small.count) == (7, 5, 0)


class TestWriting:
    def test_slot_is_marked_while_it_is_written(self, small: Ring) -> None:
        """The row that is written is the stamps themselves: what they were at that moment stands in it."""
        put(small, *range(20))
        row = small.stamps.view(np.float64)
        cycle.publish(*sections(small), row, 20_000_000, 0)
        seen = small.ticks[4, : len(row)].view(np.int64)
        assert seen.tolist() == [16, 17, 18, 19, -1, *range(5, 16)]
        assert small.stamps[4] == 20

    def test_tick_is_written_then_stamped_then_counted(self, small: Ring, monkeypatch: pytest.MonkeyPatch) -> None:
        put(small, *range(20))
        steps: list[tuple[str, int, bool, int]] = []
        row = np.full(len(TICK_COLUMNS), 20.0)

        def store(array: np.ndarray, index: int, value: int) -> None:
            there = (small.ticks[4] == row).tolist()
            assert all(there) or not any(there)
            steps.append(("stamp" if array is small.stamps else "count", int(value), all(there), int(index)))
            array[index] = value

        monkeypatch.setattr(cycle, "_store", store)
        cycle.publish.py_func(*sections(small), row, 20_000_000, 0)
        assert steps == [("stamp", -1, False, 4), ("stamp", 20, True, 4), ("count", 21, True, COUNT)]

    def test_loop_flags_are_added_once(self, small: Ring) -> None:
        small.header[MARKS] = int(TickFlag.SWAPPED)
        for _ in range(2):
            row = np.full(len(TICK_COLUMNS), float(TickFlag.TOUCHING))
            cycle.finish(sections(small), row, 0, -1)
        both = int(TickFlag.TOUCHING | TickFlag.SWAPPED)
        assert small.since(0)[0][:, cycle.FLAGS].tolist() == [both, int(TickFlag.TOUCHING)]

    def test_histogram_values_beyond_the_range_are_in_the_last_bin(self, small: Ring) -> None:
        small.header[PERIOD_NS] = 1_000_000
        rest = np.zeros(len(TICK_COLUMNS))
        for at_ns, late_ns in ((0, -5_000), (10**10, 10**10), (10**10 + 10**6, 999), (10**10 + 10**6 + 10, 1000)):
            cycle.finish(sections(small), rest.copy(), at_ns, late_ns)
        assert {int(each): int(small.late[each]) for each in np.flatnonzero(small.late)} == {
            0: 2,
            1: 1,
            WIDEST_US - 1: 1,
        }
        assert {int(each): int(small.period[each]) for each in np.flatnonzero(small.period)} == {
            0: 1, 1000: 1, WIDEST_US - 1: 1,
        }  # fmt: skip
        assert small.sums[MOST_LATE_S] == 10.0


class TestFile:
    def test_attached_ring_has_the_same_contents(self, small: Ring) -> None:
        put(small, 0, 1)
        other = Ring.attach(small.path)
        assert other.header[COUNT] == 2
        assert other.header[SLOTS] == 16
        np.testing.assert_array_equal(other.since(0)[0], small.since(0)[0])

    def test_sections_are_at_the_documented_offsets(self, small: Ring) -> None:
        """By the documented layout alone, as a reader in another language finds them."""
        put(small, 0, 7)
        data = small.path.read_bytes()
        at = 8 * (64 + 64 + 128 + 4096 + 4096 + 32768)
        assert np.frombuffer(data, np.int64, 2, at).tolist() == [0, 1]
        ticks = np.frombuffer(data, np.float64, 16 * len(TICK_COLUMNS), at + 16 * 8).reshape(16, -1)
        assert ticks[1, 0] == 7

    @pytest.mark.parametrize("content", [b"", b"x" * 100, bytes(100_000)])
    def test_file_that_is_not_a_ring_is_refused(self, tmp_path: Path, content: bytes) -> None:
        (tmp_path / "x.ring").write_bytes(content)
        with pytest.raises(DeviceError, match=r"x\.ring"):
            Ring.attach(tmp_path / "x.ring")

    @pytest.mark.parametrize("word", [IS_MAGIC, IS_LAYOUT, SLOTS])
    def test_ring_of_another_layout_is_refused(self, small: Ring, word: int) -> None:
        small.header[word] += 1
        with pytest.raises(DeviceError, match="is not a ring of layout"):
            Ring.attach(small.path)
        small.header[word] -= 1
        Ring.attach(small.path)

    def test_sections_begin_at_multiples_of_64_bytes(self) -> None:
        odd = Ring.create(5)
        try:
            put(odd, *range(7))
            data = odd.path.read_bytes()
        finally:
            odd.remove()
        at = 8 * (64 + 64 + 128 + 4096 + 4096 + 32768)
        assert np.frombuffer(data, np.int64, 5, at).tolist() == [5, 6, 2, 3, 4]
        assert np.frombuffer(data, np.float64, 1, at + 64)[0] == 5
        assert len(data) % 64 == 0

    def test_missing_ring_is_refused(self, tmp_path: Path) -> None:
        with pytest.raises(DeviceError, match="no force loop runs there"):
            Ring.attach(tmp_path / "none.ring")

    def test_ring_without_room_is_an_error(self, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
        monkeypatch.setattr(ring, "shared_folder", lambda: tmp_path / "missing")
        with pytest.raises(DeviceError, match="no room"):
            Ring.create()

    def test_shared_folder_can_be_configured(self, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
        """So that two runs of tests at once do not delete each other's files."""
        monkeypatch.setenv("TANGIBLE_SHARED_DIR", str(tmp_path))
        made = Ring.create(16).path, parcel.pack([1])
        assert {path.parent for path in made} == {tmp_path}
        assert set(tmp_path.iterdir()) == set(made)

    def test_files_of_killed_processes_are_deleted(self) -> None:
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

    def test_files_of_others_and_odd_files_are_not_deleted(self, tmp_path: Path, monkeypatch) -> None:
        """Files of other names, a folder, a link, a file that cannot be deleted, and a file of another user."""
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

        (tmp_path / "tangible-999999994-x.ring").touch()
        unlink, tried = Path.unlink, []

        def first_refused(path: Path, missing_ok: bool = False) -> None:
            tried.append(path)
            if len(tried) == 1:
                raise PermissionError(1, "not permitted", str(path))
            unlink(path, missing_ok)

        with monkeypatch.context() as sticky:
            sticky.setattr(Path, "unlink", first_refused)
            made = Ring.create(16)
        assert len(tried) == 2
        assert [path.exists() for path in tried] == [True, False]
        made.remove()

    def test_documented_table_matches_the_layout(self) -> None:
        """Name, type and shape of each section, for readers in other languages."""
        types = {np.int64: "int64", np.float64: "float64", np.float32: "float32"}
        for name, (kind, shape) in ring._sections(12345).items():
            said = ", ".join(map(str, shape)).replace("12345", "n") + ("," if len(shape) == 1 else "")
            assert f"| {name} | {types[kind]} ({said}) |" in (ring.__doc__ or "")


class TestReport:
    def test_report_of_empty_ring_is_empty(self, small: Ring) -> None:
        assert report(small).ticks == 0

    def test_report_has_the_sums_of_the_ring(self, small: Ring) -> None:
        """Force and position are (k, k, k) at tick k: the work is that of each force over the way to the next tick."""
        put(small, *range(20))
        found = report(small, "over")
        assert (found.ticks, found.stopped, found.overruns) == (20, "over", 0)
        assert found.peak_force_n == pytest.approx(19 * np.sqrt(3))
        assert found.work_j == pytest.approx(3 * sum(range(19)))
        assert found.period_us == (1000, 1000, 1000, 1000)
        assert found.late_us == (18, 38, 38, 38)

    def test_report_has_each_number_under_its_name(self, small: Ring) -> None:
        row = np.arange(100.0, 100.0 + len(TICK_COLUMNS))
        cycle.finish(sections(small), row, 5, 7_000)
        small.header[OVERRUNS], small.guard[COUNTS + 2] = 3, 8
        found = report(small)
        assert found.time_s == 100
        assert found.state == HapticState((102, 103, 104), (105, 106, 107), 100, 115)
        assert found.force == Force(111, 112, 113)
        assert (found.overruns, found.flagged) == (3, {"SLEW_LIMITED": 8})
        assert found.late_us == pytest.approx((7, 7, 7, 7))
        assert found.period_us == (0, 0, 0, 0)

    def test_report_has_the_greatest_values_of_all_ticks(self, small: Ring) -> None:
        for at_ns, late_ns, force_n in ((0, 50_000, 3.0), (5_000_000, 2_000, 1.0), (6_000_000, 0, 0.0)):
            row = np.zeros(len(TICK_COLUMNS))
            row[11] = force_n
            cycle.finish(sections(small), row, at_ns, late_ns)
        found = report(small)
        assert found.peak_force_n == 3
        assert found.late_us is not None and found.late_us.most == pytest.approx(50)
        assert found.period_us is not None and found.period_us.most == pytest.approx(5000)

    def test_report_contact_matches_the_recording(self, small: Ring) -> None:
        """Ticks with a force, whatever the law gave before its force was limited."""
        for force_n in (0.0, 2.0004, 5.0, 5.0, 1e9):
            row = np.zeros(len(TICK_COLUMNS))
            row[11], row[cycle.FLAGS] = force_n, TickFlag.TOUCHING
            cycle.finish(sections(small), row, 0, 0)
        small.guard[COUNTS] = 5
        live, kept = figures(report(small)), Recording(small.since(0)[0]).figures()
        assert live["contact_share"] == kept["contact_share"] == 0.8
        assert live["median_contact_force_n"] == pytest.approx(kept["median_contact_force_n"], abs=1e-3)
        assert np.flatnonzero(small.contact).tolist() == [2000, 5000, len(small.contact) - 1]

    def test_totals_of_consecutive_loops_are_added(self, small: Ring) -> None:
        put(small, *range(20))
        small.guard[COUNTS + 2] = 8
        small.header[OVERRUNS] = 3
        one = report(small)
        both = report(small, "over", LoopTotals.of(small), 100.0)
        assert (both.ticks, both.overruns, both.flagged) == (40, 6, {"SLEW_LIMITED": 16})
        assert (both.time_s, both.work_j) == (one.time_s + 100, 2 * one.work_j)
        same = ("peak_force_n", "period_us", "late_us", "contact_share", "median_contact_force_n")
        assert [getattr(both, each) for each in same] == [getattr(one, each) for each in same]

    def test_spread_has_the_quantiles_of_a_histogram(self) -> None:
        counts = np.zeros(100, np.int64)
        counts[[10, 20, 30, 40]] = 989, 10, 1, 0
        assert spread(counts, 31e-6) == (10, 20, 20, 31)
