"""Rows shared among threads, and their elementary functions: a map would have holes, or values that differ."""

from collections.abc import Iterable
from threading import Barrier, Event, get_ident

import numpy as np
import pytest

from tangible_core.compiled.elementary import exponentials, hyperbolic_tangents, logarithms
from tangible_core.compiled.threads import in_blocks, in_turns, run_all


@pytest.mark.parametrize(("most", "shares"), [(None, 5), (3, 3), (1, 1), (9, 5)])
def test_in_turns_covers_every_task_once_within_the_requested_shares(most, shares, monkeypatch):
    monkeypatch.setattr("tangible_core.compiled.threads.thread_count", lambda: 5)
    seen = []
    in_turns(list(range(17)), seen.append, most)
    assert len(seen) == shares
    assert sorted(task for share in seen for task in share) == list(range(17))


def test_long_tasks_wait_for_nobody_and_interrupts_come_before_their_errors(monkeypatch):
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
    monkeypatch.setattr("tangible_core.compiled.threads.thread_count", lambda: 2)
    others = Barrier(2, timeout=10)
    left = iter((2, 1, 0))

    def work(share: Iterable[str]) -> None:
        for task in share:
            if task == "long" or next(left) == 0:
                others.wait()  # the long task ends when all others are done

    in_turns(["long", "short", "short", "short"], work)


@pytest.mark.parametrize("length", [0, 1, 15, 16, 100])
def test_in_blocks_covers_a_range_once(length, monkeypatch):
    monkeypatch.setattr("tangible_core.compiled.threads.thread_count", lambda: 3)
    seen = []
    in_blocks(length, lambda start, stop: seen.append((start, stop, get_ident())))
    assert [place for start, stop, _ in sorted(seen) for place in range(start, stop)] == list(range(length))
    assert all(stop - start >= 16 for start, stop, _ in seen if length >= 32)


RANDOM = np.random.default_rng(0)


def test_exponential_is_correct_within_two_last_bits_and_clamped():
    values = np.append(RANDOM.uniform(-86, 87, 100_000), [0, 1, -1]).astype(np.float32)
    np.testing.assert_allclose(exponentials(values), np.exp(values.astype(np.float64)), rtol=2.5e-7)
    assert exponentials(np.zeros((2, 3), np.float32)).tolist() == [[1, 1, 1], [1, 1, 1]]
    ends = exponentials(np.array([-np.inf, -1e30, -87, 88, 1e30, np.inf], np.float32))
    assert ends[0] == ends[1] == ends[2] == pytest.approx(np.exp(-87), rel=1e-6, abs=0)
    assert ends[3] == ends[4] == ends[5] == pytest.approx(np.exp(88), rel=1e-6)


def test_logarithm_and_tangent_are_correct_within_the_last_bits():
    values = np.append(np.exp(RANDOM.uniform(-87, 88, 100_000)), RANDOM.uniform(0.5, 2, 100_000)).astype(np.float32)
    np.testing.assert_allclose(logarithms(values), np.log(values.astype(np.float64)), rtol=2.5e-7)
    assert logarithms(np.ones(1, np.float32)).tolist() == [0]
    values = np.append(RANDOM.normal(0, 2, 100_000), 10.0 ** -np.arange(30)).astype(np.float32)
    expected = np.tanh(values.astype(np.float64))
    np.testing.assert_allclose(hyperbolic_tangents(values), expected, rtol=5e-7)
    assert (hyperbolic_tangents(-values) == -hyperbolic_tangents(values)).all()
    assert hyperbolic_tangents(np.array([-np.inf, np.inf], np.float32)).tolist() == [-1, 1]
