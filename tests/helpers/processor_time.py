"""A plugin of pytest that notes each test's processor time, with that of all processes it starts and uses.

`python -m benchmarks tests` runs pytest with it and sums by room. `-p processor_time`, with the file to write named in
TANGIBLE_TEST_TIMES: lines of JSON, a test's id and its seconds; each worker writes one, whose name ends with its own.
"""

import json
import os
import time
from collections.abc import Generator
from contextlib import suppress
from pathlib import Path
from typing import Any

import pytest

TICKS_PER_S = os.sysconf("SC_CLK_TCK")


def pytest_configure(config: pytest.Config) -> None:
    worker = os.environ.get("PYTEST_XDIST_WORKER", "alone")
    config.pluginmanager.register(Times(Path(f"{os.environ['TANGIBLE_TEST_TIMES']}.{worker}")))


class Times:
    """Writes a line for each test."""

    def __init__(self, path: Path) -> None:
        self._path = path

    @pytest.hookimpl(wrapper=True, tryfirst=True)
    def pytest_runtest_protocol(self, item: pytest.Item) -> Generator[None, Any, Any]:
        before_s = used_s()
        result = yield
        with self._path.open("a") as file:
            # a browser that ends takes its time with it, which was counted while it ran
            file.write(json.dumps([item.nodeid, max(0.0, used_s() - before_s)]) + "\n")
        return result


def used_s() -> float:
    """Processor time of this process, of its children that ended and, on Linux, of those that run, and theirs."""
    ended, waiting, total_s = os.times(), _children(os.getpid()), time.process_time()
    total_s += ended.children_user + ended.children_system
    while waiting:
        process = waiting.pop()
        waiting += _children(process)
        with suppress(OSError):
            fields = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()
            total_s += sum(map(int, fields[11:15])) / TICKS_PER_S  # its own, and its children's that ended
    return total_s


def _children(process: int) -> list[int]:
    with suppress(OSError):
        tasks = Path(f"/proc/{process}/task").iterdir()
        return [int(word) for task in tasks for word in (task / "children").read_text().split()]
    return []
