"""Errors without times, from workers that stay warm: the same to the last digit as those of a timed comparison."""

from pathlib import Path

import pytest

import dask_imported  # noqa: F401
from command_line import tangible
from farm_here import Here
from tangible_bench.comparing import ComparisonOutcome, Step, compare
from tangible_bench.config.reading import errors_only, parse_comparison
from tangible_bench.measuring.rows import read_rows
from tangible_core.plugins.registry import Registry

FILE = """
compare: depth
methods: [half, raises, fails, dies, {use: semi-global, given: [max_disparity_px]}]
scenes: [{synthetic: steps, width_px: 48, height_px: 32}]
perturb: [{noise: 5}]
fill: [half]
repeats: 1
warmups: 0
calls: 1
baseline: half
"""


def run_comparison(registry: Registry, folder: Path, without_times: bool, **how) -> ComparisonOutcome:
    comparison = parse_comparison(f"{FILE}out: {folder}/out\n", Path("c.yaml"), registry)
    return compare(errors_only(comparison) if without_times else comparison, **how)


@pytest.mark.whole
@pytest.mark.usefixtures("cells_here")
def test_errors_alone_equal_those_of_timed_measurements(registry: Registry, tmp_path: Path):
    timed = run_comparison(registry, tmp_path, False)
    heard: list[Step] = []
    found = run_comparison(registry, tmp_path, True, workers=1, progress=heard.append)
    assert found.results.cells.keys() == timed.results.cells.keys()
    assert len(heard) == 5
    for key, cell in found.results.cells.items():
        before = timed.results.cells[key]
        assert not cell.seconds
        assert not cell.memory_bytes
        assert repr(cell.measures) == repr(before.measures)
        if "dies" in key:
            assert before.error
            assert "its worker died of it" in (cell.error or "")
        else:
            assert (cell.error or "").partition("; ")[0] == (before.error or "").partition("; ")[0]
    assert found.results.methods_without_result == timed.results.methods_without_result == ["raises", "fails", "dies"]
    rows = read_rows(tmp_path / "out-errors/results.jsonl")
    assert not rows.keys() & read_rows(tmp_path / "out/results.jsonl").keys()
    assert {row.seconds for row in rows.values()} == {None}

    run_comparison(registry, tmp_path, True, progress=lambda step: pytest.fail("nothing is left to measure"))


@pytest.mark.usefixtures("cells_here")
def test_command_with_errors_only_reports_no_times_and_alone_takes_workers(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setattr("tangible_bench.measuring.run.Farm", Here)
    scenes = "{synthetic: steps, width_px: 64, height_px: 48}, {synthetic: bars, width_px: 64, height_px: 48}"
    (tmp_path / "c.yaml").write_text(f"compare: depth\nmethods: [half]\nscenes: [{scenes}]\nout: {tmp_path}/out\n")
    done = tangible("compare", "c.yaml", "--errors-only", "--workers", 1, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "half is the most exact" in done.stdout and "times were not measured" in " ".join(done.stdout.split())
    assert not (tmp_path / "out").exists()
    done = tangible("compare", "c.yaml", "--workers", 2, cwd=tmp_path)
    assert done.returncode == 2 and "--workers" in done.stderr
