"""Times of several calls that take turns, so that whatever else the machine does meets all alike."""

import gc
from collections.abc import Callable, Mapping
from statistics import median
from time import perf_counter, process_time
from typing import NamedTuple

import numpy as np

from tangible_bench.memory import start_peak

Call = Callable[[], object]


class Timed(NamedTuple):
    """Median seconds, and the median of (seconds / seconds of the first call in the same round)."""

    seconds: float
    ratio: float


def in_turns(calls: Mapping[str, Call], rounds: int, clock: Callable[[], float] = perf_counter) -> dict[str, Timed]:
    """Each call once a round, after one round that is not counted; the first one is what the others are divided by.

    clock: `time.thread_time` for what takes less than a time slice and one thread, on a machine that does other work.

    The order is by chance, another one each round: what a call leaves behind (threads that still spin, memory to give
    back) meets all of the others.
    """
    for call in calls.values():
        call()
    order, each = np.random.default_rng(0), list(calls.values())
    times = np.empty((rounds, len(each)))
    for row in times:
        for i in order.permutation(len(each)):
            row[i] = seconds(each[i], clock)
    ratios = times / times[:, :1]
    return {name: Timed(float(np.median(times[:, i])), float(np.median(ratios[:, i]))) for i, name in enumerate(calls)}


def seconds(call: Call, clock: Callable[[], float] = perf_counter) -> float:
    """Seconds of one call."""
    gc.collect()
    start = clock()
    call()
    return clock() - start


def processor_s(call: Call, runs: int) -> float:
    """Return the median seconds of a processor that a call takes, after one that is not counted."""
    call()
    return median(seconds(call, process_time) for _ in range(runs))


def peak_bytes(call: Call) -> float:
    """Return by how much memory grows while a call runs for the second time."""
    call()
    growth = start_peak()
    call()
    return growth() or 0
