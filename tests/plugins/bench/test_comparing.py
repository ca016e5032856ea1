"""A whole comparison, and regressions between two: figures that are lost, or noise called a change."""

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
from tangible_bench.results.regressions import find_regressions
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


ROW = Row("k", "depth", "m", "m", {}, "d 1", "s", "digest", "none", (), 0, {}, {"processor": "p"})


def rows(seconds: list[float], method: str = "m", bad2: float | None = 5.0, memory: int = 10**8, **more) -> list[Row]:
    return [
        replace(
            ROW, method=method, repeat=repeat, seconds=second, peak_memory_bytes=memory, measures={"bad2": bad2}, **more
        )
        for repeat, second in enumerate(seconds)
    ]


def worse(before: list[Row], after: list[Row]) -> list[str]:
    return [each.what for each in find_regressions(before, after).worse]


@pytest.mark.parametrize(
    ("before", "after", "expected"),
    [
        ([1.0, 1.0, 1.0], [1.09, 1.09, 1.09], []),
        ([1.0, 1.0, 1.0], [1.11, 1.11, 1.11], ["time s"]),
        ([1.0, 1.0, 1.0], [0.1, 0.1, 0.1], []),
        ([0.9, 1.0, 1.1], [1.3, 1.4, 1.5], []),
        ([0.9, 1.0, 1.1], [1.6, 1.7, 1.8], ["time s"]),
        ([1.0], [1.05], []),
    ],
    ids=["within a tenth", "over a tenth", "faster", "within the noise", "over the noise", "one repeat"],
)
def test_time_is_worse_beyond_a_tenth_and_the_noise(before: list[float], after: list[float], expected: list[str]):
    assert worse(rows(before), rows(after)) == expected


@pytest.mark.parametrize(
    ("before", "after", "expected"),
    [(5.0, 5.004, []), (5.0, 5.006, ["bad2 %"]), (5.0, 1.0, []), (5.0, None, ["bad2 %"]), (None, 5.0, [])],
)
def test_error_is_worse_beyond_its_tolerance(before: float | None, after: float | None, expected: list[str]):
    assert worse(rows([1.0], bad2=before), rows([1.0], bad2=after)) == expected


def test_changes_have_bounds_of_their_own_as_means_and_ratios():
    for before, after, expected in ((10**8, 104 * 10**6, []), (10**8, 106 * 10**6, ["memory bytes"]), (0, 10**6, [])):
        assert worse(rows([1.0], memory=before), rows([1.0], memory=after)) == expected
    high, low = ([replace(ROW, seconds=1.0, measures={"density": value})] for value in (90.0, 80.0))
    assert worse(high, low) == ["density %"] and worse(low, high) == []
    (found,) = find_regressions(rows([0.9, 1.0, 1.1]), rows([1.6, 1.7, 1.8])).worse
    assert found.allowed == pytest.approx(3 * 2**0.5 * 1.4826 * 0.1), "three standard deviations"
    assert (found.before, found.after) == (1.0, 1.7)
    before = rows([1.0], baseline="base") + rows([2.0], "base", baseline="base")
    other = {"baseline": "base", "machine": {"processor": "q"}}
    assert worse(before, rows([10.0], **other) + rows([20.0], "base", **other)) == []
    assert worse(before, rows([12.0], **other) + rows([20.0], "base", **other)) == ["time / baseline"]
    (found,) = find_regressions(rows([1.0]), [replace(ROW, error="gone")]).worse
    assert (found.what, found.why) == ("fails", "gone")
    assert worse([replace(ROW, error="gone")], rows([1.0])) == []
    assert worse([replace(ROW, error="gone")], [replace(ROW, error="still")]) == []
    verdict = find_regressions(rows([1.0]) + rows([1.0], "gone"), rows([1.0]) + rows([1.0], "new"))
    assert (verdict.compared, verdict.missing) == (1, ("gone | s | none", "new | s | none"))


@pytest.mark.parametrize(
    ("after", "why"),
    [
        ([], "a file without rows"),
        (rows([1.0], compare="texture"), "compares depth, the other texture"),
        (rows([1.0], machine={"processor": "q"}), "seconds on p and on q"),
        (rows([1.0], "other"), "in common"),
        (rows([1.0], scene_digest="other"), "in common"),
    ],
)
def test_files_without_common_ground_are_refused(after: list[Row], why: str):
    with pytest.raises(ResultsError, match=why):
        find_regressions(rows([1.0]), after)
