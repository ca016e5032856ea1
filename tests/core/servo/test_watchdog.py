"""The watchdog: a loop that stands still keeps its last force on the hand, and one that is well must not be ended."""

import numpy as np
import pytest

from tangible_core.servo import limits, watchdog
from tangible_core.servo.ring import COUNT, LAST, STOP

TICKING = [5, 5, 5, 5, *[6] * 99]


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """The time in 64ths of a second, which are exact, as the watchdog reads it."""
    now = [0]
    monkeypatch.setattr(watchdog, "monotonic", lambda: now[0] / 64)
    return now


def polls_until_expired(clock: list[int], counts: list[int], word: int = -1, step: int = 1) -> int:
    header = np.zeros(max(COUNT, LAST, STOP) + 1, np.int64)
    header[LAST] = 5 if word == LAST else 1000
    if word == STOP:
        header[word] = 1
    dog = watchdog.Watchdog(header, stopping_s=3.0)
    for poll, count in enumerate(counts, 1):
        clock[0] += step
        header[COUNT] = count
        if dog.expired(0.25):
            return poll
    return 0


@pytest.mark.parametrize(
    ("counts", "word", "polls"),
    [
        ([5] * 99, -1, 17),  # a quarter of a second after the first poll, which saw the count
        (TICKING, -1, 21),
        ([5] * 200, STOP, 193),
        ([5] * 200, LAST, 193),
        (list(range(1, 99)), -1, 0),
    ],
)
def test_watchdog_expires_after_its_limit_without_a_tick(clock: list[int], counts: list[int], word: int, polls: int):
    assert polls_until_expired(clock, counts, word) == polls


def test_watchdog_that_stood_still_itself_polls_four_times_before_it_expires(clock: list[int]):
    assert polls_until_expired(clock, [5] * 99, step=640) == 1 + limits.WATCHDOG_POLLS


def test_limits_of_a_watchdog_follow_its_polls_and_the_period_of_its_loop():
    assert watchdog.timeout_s(0.2, 0.001) == 0.2
    assert watchdog.timeout_s(0.2, 0.3) == pytest.approx(1.2)
    assert limits.WATCHDOG_POLLS * limits.WATCHDOG_POLL_S < limits.WATCHDOG_OWN_SHARE * limits.MIN_WATCHDOG_S
