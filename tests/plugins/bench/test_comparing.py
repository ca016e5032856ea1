"""A whole comparison, by the command and by a program: figures that are lost, or worse ones that nobody notices."""

import json
import threading
from concurrent.futures import ThreadPoolExecutor, wait
from dataclasses import replace
from pathlib import Path

import pytest

from command_line import tangible
from tangible_bench.comparing import ComparisonOutcome, Step, compare, read_comparison
from tangible_bench.config.reading import load_comparison, parse_comparison
from tangible_bench.measuring.rows import Row, append, read_rows
from tangible_core.errors import ResultsError, Stopped
from tangible_core.plugins.registry import Registry, default_registry
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
    assert [(each.number, each.of, each.is_end) for each in heard] == [
        (0, 2, False),
        (0, 2, True),
        (1, 2, False),
        (1, 2, True),
    ]
    assert [each.row.seconds is None for each in heard] == [True, False, True, False]
    assert {mean.method for mean in found.results.means()} == {"constant", "half"}
    assert all(path.exists() for path in found.files)


@pytest.mark.usefixtures("cells_here")
def test_stopped_comparison_continues_where_it_stopped(registry: Registry, tmp_path: Path):
    stop = threading.Event()
    with pytest.raises(Stopped):
        run_comparison(
            registry, tmp_path, "constant, half", progress=lambda step: step.is_end and stop.set(), stop=stop
        )
    heard: list[Step] = []
    run_comparison(registry, tmp_path, "constant, half", progress=heard.append)
    assert [each.row.method for each in heard if each.is_end] == ["half"]


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


ROOT = Path(__file__).parents[3]
TEXT = """\
compare: depth
methods: [constant, half, raises]
scenes: [{synthetic: steps, width_px: 64, height_px: 32}]
repeats: 1
warmups: 0
calls: 1
baseline: constant
out: out
"""


@pytest.mark.parametrize("path", sorted(ROOT.glob("configs/compare-*.yaml")), ids=lambda path: path.name)
def test_sample_comparisons_are_valid(path: Path):
    assert load_comparison(path, default_registry()).methods


@pytest.mark.usefixtures("cells_here")
def test_command_measures_shows_and_finds_regressions(tmp_path: Path):
    rows = tmp_path / "out" / "results.jsonl"
    (tmp_path / "c.yaml").write_text(TEXT)
    done = tangible("compare", "c.yaml", cwd=tmp_path)
    assert done.returncode == 1, done.stderr
    assert "no result on any scene: raises" in done.stderr
    failure = "PictureError: not this picture"
    for word in ("constant", "half", "raises", "baseline", "no result", failure, "out/results.jsonl"):
        assert word in done.stdout
    assert (tmp_path / "out" / "plot.png").is_file()

    tangible("compare", "c.yaml", "--quick", cwd=tmp_path)
    assert (tmp_path / "out-quick" / "results.jsonl").is_file()

    # A method that failed on one scene of several has results; without the one that failed on all of them, so has all.
    good = tmp_path / "good.jsonl"
    for row in read_rows(rows).values():
        if row.method != "raises":
            append(good, row)
            append(
                good, replace(row, scene="elsewhere", key=row.key + "2", error="no" if row.method == "half" else None)
            )
    done = tangible("compare", good, cwd=tmp_path)
    assert done.returncode == 0, done.stderr

    # The same file against itself: nothing is measured, nothing is worse.
    rows.write_text(good.read_text())
    done = tangible("compare", rows, "--against", rows, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "4 cells compared, times as ratios to constant; 0 figures got worse" in done.stdout

    # Against results that were better.
    better = tmp_path / "better.jsonl"
    for row in read_rows(rows).values():
        append(better, better_than(row) if row.method == "half" else row)
    done = tangible("compare", rows, "--against", better, "--json", cwd=tmp_path)
    assert done.returncode == 1, done.stderr
    worse = json.loads(done.stdout)["against"]["worse"]
    assert {each["method"] for each in worse} == {"half"}
    assert "bad2 %" in {each["what"] for each in worse}


def better_than(row: Row) -> Row:
    return replace(row, measures={**row.measures, "bad2": 0.0})


@pytest.mark.parametrize(
    ("words", "why"),
    [
        (["missing.yaml"], "there is no such file"),
        (["missing.jsonl"], "cannot be read as results"),
        (["empty.jsonl"], "holds no row"),
        (["wrong.yaml"], "wrong.yaml:1:1: `compare:` names what kind"),
        (["good.yaml", "--against", "missing.jsonl"], "cannot be read as results"),
    ],
)
@pytest.mark.usefixtures("cells_here")
def test_command_with_a_mistake_exits_with_2_and_a_message(tmp_path: Path, words: list[str], why: str):
    (tmp_path / "empty.jsonl").write_text("")
    (tmp_path / "wrong.yaml").write_text("compare: nothing\n")
    (tmp_path / "good.yaml").write_text(TEXT)
    done = tangible("compare", *words, cwd=tmp_path)
    assert done.returncode == 2, done.stderr
    assert why in done.stderr
    assert "Traceback" not in done.stderr
    assert not (tmp_path / "out").exists()
