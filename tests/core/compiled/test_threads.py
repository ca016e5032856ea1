"""Sharing of work among threads: a row that is left out is a hole in a map."""

from collections.abc import Iterable
from threading import Barrier, Event, get_ident

import pytest

from tangible_core.compiled.threads import in_blocks, in_turns, run_all


@pytest.mark.parametrize(("most", "shares"), [(None, 5), (3, 3), (1, 1), (9, 5)])
def test_in_turns_covers_every_task_once_within_the_requested_shares(most, shares, monkeypatch):
    monkeypatch.setattr("tangible_core.compiled.threads.thread_count", lambda: 5)
    seen = []
    in_turns(list(range(17)), seen.append, most)
    assert len(seen) == shares
    assert sorted(task for share in seen for task in share) == list(range(17))


def test_in_turns_does_not_wait_for_a_long_task(monkeypatch):
    monkeypatch.setattr("tangible_core.compiled.threads.thread_count", lambda: 2)
    others = Barrier(2, timeout=10)
    left = iter((2, 1, 0))

    def work(share: Iterable[str]) -> None:
        for task in share:
            if task == "long" or next(left) == 0:
                others.wait()  # the long task ends when all others are done

    in_turns(["long", "short", "short", "short"], work)


def test_run_all_raises_the_interrupt_before_errors_it_causes():
    interrupted, ended = Event(), Event()

    def interrupt() -> None:
        interrupted.set()
        raise KeyboardInterrupt

    def fail() -> None:
        interrupted.wait(10)
        ended.set()
        raise RuntimeError("what it needed is half done")

    with pytest.raises(KeyboardInterrupt):
        run_all([interrupt, fail])
    assert ended.is_set()
    with pytest.raises(RuntimeError, match="half done"):
        run_all([lambda: None, fail])


@pytest.mark.parametrize("length", [0, 1, 15, 16, 100])
def test_in_blocks_covers_a_range_once(length, monkeypatch):
    monkeypatch.setattr("tangible_core.compiled.threads.thread_count", lambda: 3)
    seen = []
    in_blocks(length, lambda start, stop: seen.append((start, stop, get_ident())))
    assert [place for start, stop, _ in sorted(seen) for place in range(start, stop)] == list(range(length))
    assert all(stop - start >= 16 for start, stop, _ in seen if length >= 32)
