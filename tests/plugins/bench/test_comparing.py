"""A whole comparison as a program calls it: progress, stop, and comparison with an earlier one."""

import threading
from concurrent.futures import ThreadPoolExecutor, wait
from pathlib import Path

import pytest

from tangible_bench.comparing import ComparisonOutcome, Step, compare, read_comparison
from tangible_bench.config.reading import parse_comparison
from tangible_bench.measuring.rows import read_rows
from tangible_core.errors import ResultsError, Stopped
from tangible_core.plugins.registry import Registry
from tangible_core.runtime.system.files import folder_lock

FILE = """
compare: depth
methods: [{methods}]
scenes: [{{synthetic: steps, width_px: 32, height_px: 24}}]
repeats: 1
warmups: 0
calls: 1
out: {out}
"""


def run_comparison(registry: Registry, out: Path, methods: str = "constant", **how) -> ComparisonOutcome:
    text = FILE.format(methods=methods, out=out)
    return compare(parse_comparison(text, Path("c.yaml"), registry), **how)


@pytest.mark.usefixtures("cells_here")
def test_progress_reports_start_and_end_of_every_measurement(registry: Registry, tmp_path: Path):
    heard: list[Step] = []
    found = run_comparison(registry, tmp_path, "constant, half", progress=heard.append)
    assert [(each.number, each.of, each.done) for each in heard] == [
        (0, 2, False),
        (0, 2, True),
        (1, 2, False),
        (1, 2, True),
    ]
    assert [each.row.seconds is None for each in heard] == [True, False, True, False]
    assert {each.method for each in found.results.means()} == {"constant", "half"}
    assert all(path.exists() for path in found.files)


@pytest.mark.usefixtures("cells_here")
def test_stopped_comparison_continues_where_it_stopped(registry: Registry, tmp_path: Path):
    stop = threading.Event()
    with pytest.raises(Stopped):
        run_comparison(registry, tmp_path, "constant, half", progress=lambda step: step.done and stop.set(), stop=stop)
    heard: list[Step] = []
    run_comparison(registry, tmp_path, "constant, half", progress=heard.append)
    assert [each.row.method for each in heard if each.done] == ["half"]


def test_stop_ends_a_long_measurement(registry: Registry, tmp_path: Path):
    stop = threading.Event()
    threading.Timer(0.5, stop.set).start()
    with pytest.raises(Stopped):
        run_comparison(registry, tmp_path, "{use: constant, seconds: 200}", stop=stop)


@pytest.mark.usefixtures("cells_here")
def test_results_are_read_as_they_were_measured(registry: Registry, tmp_path: Path):
    found = run_comparison(registry, tmp_path)
    again = read_comparison(tmp_path / "results.jsonl", earlier=list(read_rows(tmp_path / "results.jsonl").values()))
    assert again.results.cells == found.results.cells
    assert again.verdict is not None and not again.verdict.worse
    (tmp_path / "empty.jsonl").touch()
    with pytest.raises(ResultsError, match="holds no row of a comparison"):
        read_comparison(tmp_path / "empty.jsonl")


@pytest.mark.usefixtures("cells_here")
def test_tables_wait_for_another_process_that_writes_them(registry: Registry, tmp_path: Path):
    table, rows = tmp_path / "table.csv", tmp_path / "results.jsonl"
    text = run_comparison(registry, tmp_path).files[1].read_text()
    with ThreadPoolExecutor(1) as pool:
        with folder_lock(tmp_path):
            table.write_text("of another")
            later = pool.submit(read_comparison, rows)
            wait([later], timeout=0.5)  # time enough to write, if nothing holds it
            assert table.read_text() == "of another"
        later.result()
    assert table.read_text() == text
