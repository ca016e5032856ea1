"""The ring of a force loop: a reader gets torn ticks, or misses some without knowing."""

import numpy as np
import pytest

from ring_ticks import put
from tangible_core.data import TICK_COLUMNS, TickFlag
from tangible_core.servo import Ring
from tangible_core.servo.ring import COUNT, MARKS, MAX_LATE_S, PERIOD_NS, WIDEST_US
from tangible_core.servo.ticks import cycle
from tangible_core.servo.ticks.loop import sections


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

    def test_row_overwritten_during_the_read_is_omitted(self, small: Ring) -> None:
        put(small, *range(16))
        small.ticks = Overwritten(small)
        rows, following = small.since(0)
        whole = np.delete(rows, cycle.FLAGS, axis=1)
        assert whole.tolist() == [[number] * 16 for number in range(1, 16)]
        assert following == 16

    def test_ring_that_is_not_full_has_no_made_up_ticks(self, small: Ring) -> None:
        put(small, *range(15))
        small.stamps[15] = -1
        assert small.since(-1)[0][:, 0].tolist() == list(range(15))


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
        assert small.sums[MAX_LATE_S] == 10.0
