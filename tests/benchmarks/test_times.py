"""The budget of the tests themselves: whose seconds are counted, and by room."""

import os
import subprocess
import sys
import time
from pathlib import Path

from benchmarks import tests
from processor_time import used_s

BUSY = "import time; [None for _ in iter(lambda: time.process_time() < 0.3, False)]"


def test_processor_time_of_children_that_ended_and_of_those_that_run_is_counted():
    before_s = used_s()
    subprocess.run([sys.executable, "-c", BUSY], check=True)
    assert used_s() - before_s >= 0.25  # of 0.3, in ticks of 10 ms
    before_s = used_s()
    with subprocess.Popen([sys.executable, "-c", f"{BUSY}; input()"], stdin=subprocess.PIPE) as running:
        until_s = time.monotonic() + 60
        while used_s() - before_s < 0.25 and sys.platform == "linux":
            assert time.monotonic() < until_s
        assert running.poll() is None
        running.communicate(b"\n")


def test_rooms_that_miss_their_bound_are_marked():
    spent = {"tests/ui/test_a.py::test_b[x]": 9_999.0, "tests/test_house.py::test_c": 1.0}
    spent |= {"tests/ui/browser/test_h.py::test_i": 1.0}
    spent |= {"tests/core/parts/deep/test_d.py::T::test_e": 3.0, "tests/core/parts/test_f.py::test_g": 4.5}
    spent |= {"plugins/depth/tangible_depth/ssd.py::tangible_depth.ssd.Ssd": 0.5}
    assert list(tests.rows(spent)) == [
        ("`tests/ui`", "2", "10000.0", "150", "missed"),
        ("`tests/core/parts`", "2", "7.5", "8", ""),
        ("`tests`", "1", "1.0", "50", ""),
        ("`plugins/depth`", "1", "0.5", "8", ""),
        ("all", "6", "10009.0", "600", "missed"),
    ]


def test_lines_of_all_workers_are_read(tmp_path: Path):
    (tmp_path / "times.gw0").write_text('["a", 1.5]\n["b", 2.0]\n')
    (tmp_path / "times.gw1").write_text('["c", 0.25]\n')
    assert tests.seconds_of_tests(tmp_path) == {"a": 1.5, "b": 2.0, "c": 0.25}


def test_bounds_of_rooms_leave_time_for_the_others():
    root = Path(tests.__file__).parents[1]
    assert all(root.joinpath(name).is_dir() for name in tests.BUDGET_S)
    assert sum(tests.BUDGET_S.values()) < 600


def test_test_with_one_slow_case_is_slow():
    spent = {"tests/test_a.py::test_b[x]": 0.05, "tests/test_a.py::test_b[y]": 0.3, "tests/test_a.py::test_c": 0.05}
    assert tests.slow_tests(spent) == ["tests/test_a.py::test_b"]


def test_kernels_kept_since_a_moment_are_counted(tmp_path: Path):
    for name, at_s in (("before.nbc", 90.0), ("in/since.nbc", 100.0), ("in/since.nbi", 110.0)):
        path = tmp_path / name
        path.parent.mkdir(exist_ok=True)
        path.touch()
        os.utime(path, (at_s, at_s))
    assert tests.compiled_since(100.0, tmp_path) == 1
