"""A whole comparison as a program calls it: heard of, stopped, and held against an earlier one."""

import threading
from pathlib import Path

import pytest

from tangible_bench.comparing import ComparisonOutcome, Step, compare, read_comparison
from tangible_bench.config.reading import parse_comparison
from tangible_bench.measuring.rows import read_rows
from tangible_core.errors import ResultsError, Stopped
from tangible_core.plugins.registry import Registry

FILE = """
compare: depth
methods: [{methods}]
scenes: [{{synthetic: steps, width_px: 32, height_px: 24}}]
repeats: 1
warmups: 0
calls: 1
out: {out}
"""


def compared(registry: Registry, out: Path, methods: str = "constant", **how) -> ComparisonOutcome:
    text = FILE.format(methods=methods, out=out)
    return compare(parse_comparison(text, Path("c.yaml"), registry), **how)


@pytest.mark.usefixtures("cells_here")
def test_every_measurement_is_heard_of_as_it_begins_and_ends(registry: Registry, tmp_path: Path):
    heard: list[Step] = []
    found = compared(registry, tmp_path, "constant, half", progress=heard.append)
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
def test_it_goes_on_where_it_was_stopped(registry: Registry, tmp_path: Path):
    stop = threading.Event()
    with pytest.raises(Stopped):
        compared(registry, tmp_path, "constant, half", progress=lambda step: step.done and stop.set(), stop=stop)
    heard: list[Step] = []
    compared(registry, tmp_path, "constant, half", progress=heard.append)
    assert [each.row.method for each in heard if each.done] == ["half"]


def test_a_long_measurement_is_ended(registry: Registry, tmp_path: Path):
    stop = threading.Event()
    threading.Timer(0.5, stop.set).start()
    with pytest.raises(Stopped):
        compared(registry, tmp_path, "{use: constant, seconds: 200}", stop=stop)


@pytest.mark.usefixtures("cells_here")
def test_what_was_measured_is_read_again(registry: Registry, tmp_path: Path):
    found = compared(registry, tmp_path)
    again = read_comparison(tmp_path / "results.jsonl", earlier=list(read_rows(tmp_path / "results.jsonl").values()))
    assert again.results.cells == found.results.cells
    assert again.verdict is not None and not again.verdict.worse
    (tmp_path / "empty.jsonl").touch()
    with pytest.raises(ResultsError, match="holds no row of a comparison"):
        read_comparison(tmp_path / "empty.jsonl")
