"""Results of a comparison as medians, tables and plots: exact answers from rows that are made up."""

import csv
import io
import math
from dataclasses import replace
from pathlib import Path

import cv2
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tangible_bench.commands.progress import Forecast, forecast
from tangible_bench.comparing import compare, read_comparison
from tangible_bench.config.reading import Comparison, Damage, parse_comparison, shorten
from tangible_bench.measuring.plan import measurements
from tangible_bench.measuring.rows import Row
from tangible_bench.measuring.run import look
from tangible_bench.results.plot import draw_plot
from tangible_bench.results.summary import Cell, cells, lines, spread
from tangible_bench.results.table import Results, front, tables
from tangible_bench.tasks.task import load_task
from tangible_core.metrics.measured import load_measured
from tangible_core.plugins.registry import Registry, default_registry

ROW = Row("k", "depth", "m", "m", {}, "d 1", "s", "digest", "none", (), 0, {}, {"processor": "p"}, seconds=1.0)


def row(method: str, repeat: int, seconds: float | None, scene: str = "s", perturb: str = "none", **more) -> Row:
    key = f"{method} {scene} {perturb} {repeat}"
    return replace(ROW, key=key, method=method, repeat=repeat, seconds=seconds, scene=scene, perturb=perturb, **more)


def test_ratio_is_median_of_pairs_within_a_round():
    """The machine slows down tenfold in the last round: pairs do not notice, medians of each alone would."""
    rows = [row("base", 0, 1.0), row("fast", 0, 0.5), row("base", 1, 1.0), row("fast", 1, 0.5)]
    rows += [row("base", 2, 10.0), row("fast", 2, 5.0)]
    found = cells(rows, "base")
    assert found["fast", "s", "none"].ratios == [0.5, 0.5, 0.5]
    assert found["base", "s", "none"].ratios == [1, 1, 1]
    assert cells(rows[1:], "base")["fast", "s", "none"].ratios == [0.5, 0.5], "no baseline in the first round"
    (base, fast) = lines(found, "none", ["s"])
    assert (base.ratio, fast.ratio, fast.seconds) == (1, 0.5, 0.5)


def test_lines_over_scenes_are_means_of_those_with_truth_and_result():
    rows = [
        row("m", 0, 1.0, "a", measures={"bad2": 2.0}, peak_memory_bytes=10),
        row("m", 0, 3.0, "b", measures={"bad2": 4.0}, peak_memory_bytes=30),
        row("base", 0, 2.0, "a", measures={"bad2": 1.0}),
        row("base", 0, 1.5, "b", measures={"bad2": None}),
    ]
    m, base = lines(cells(rows, "base"), "none", ["a", "b"])
    assert (m.seconds, m.measures["bad2"], m.memory_bytes, m.done) == (2.0, 3.0, 30, 2)
    assert m.ratio == pytest.approx(math.sqrt(0.5 * 2.0))
    assert math.isnan(base.measures["bad2"])
    assert math.isnan(base.memory_bytes)
    rows = [row(name, 0, 1.0, "a", measures={"bad2": value}) for name, value in (("m", 2.0), ("n", None))]
    rows += [row(name, 0, 3.0, "b", measures={"bad2": None}) for name in "mn"]
    m, n = lines(cells(rows, None), "none", ["a", "b"])
    assert (m.seconds, m.measures["bad2"], m.done) == (2.0, 2.0, 2)
    assert math.isnan(n.measures["bad2"])
    rows = [row("m", 0, 1.0, "a", measures={"bad2": 2.0}), row("m", 0, None, "b", error="no")]
    (m,) = lines(cells(rows, None), "none", ["a", "b"])
    assert math.isnan(m.seconds)
    assert (m.measures, m.done, m.scenes) == ({}, 1, 2)


def test_spread_is_scaled_median_deviation():
    assert spread([1, 2, 3, 4, 100]) == pytest.approx(1.4826)
    assert (spread([5]), spread([])) == (0, 0)


points = st.lists(st.tuples(st.integers(0, 5), st.integers(0, 5)), max_size=12)


@given(points)
def test_front_has_exactly_the_unbeaten_points(found: list[tuple[int, int]]):
    best = [found[index] for index in front(found)]
    assert best == sorted(best)
    for point in found:
        beaten = any(other != point and other[0] <= point[0] and other[1] <= point[1] for other in found)
        assert (point in best) is not beaten
    assert front([(1.0, float("nan")), (float("nan"), 0.0), (2.0, 2.0)]) == [2]


def results() -> Results:
    rows = [
        row("slow", 0, 2.0, measures={"bad2": 1.0, "density": 100.0}),
        row("fast", 0, 1.0, measures={"bad2": 3.0, "density": 90.0}),
        row("bad", 0, 3.0, measures={"bad2": 9.0, "density": 80.0}),
        row("slow", 0, 2.0, perturb="noise 5", measures={"bad2": 2.0}),
        row("fast", 0, 1.0, perturb="noise 5", measures={"bad2": 30.0}),
        row("bad", 0, None, perturb="noise 5", error="gone"),
    ]
    return Results(load_task("depth"), cells(rows, "fast"), "fast")


def test_tables_rank_means_by_the_better_way():
    overview, perturbed, failures = tables(results())
    assert [(line[0], line[1], line[2], line[3]) for line in overview.rows] == [
        ("slow", "*", "2000.0", "2.00"),
        ("fast", "*", "1000.0", "1.00"),
        ("bad", "", "3000.0", "3.00"),
    ]
    assert perturbed.headings == ("method", "none", "noise 5")
    assert perturbed.rows == (("slow", "1.00", "2.00"), ("fast", "3.00", "30.00"), ("bad", "9.00", "-"))
    assert failures.rows == (("bad", "s, noise 5", "gone"),)
    detailed = tables(results(), detail=True)
    assert [table.title for table in detailed[2:-1]] == ["s", "s, noise 5"]
    assert "density noc %" in detailed[2].headings and "A90 px" not in detailed[2].headings
    found = results()
    lines_ = found.means()
    assert [line.method for line in sorted(lines_, key=lambda line: found.loss(line, "density"))] == [
        "slow",
        "fast",
        "bad",
    ]
    assert [lines_[index].method for index in found.on_front(lines_, "density")] == ["fast", "slow"]


def results_at(points: dict[str, tuple[float, float]]) -> Results:
    found = [
        Cell(name, "s", "none", seconds=[seconds], measures={"bad2": bad2, "bad2_noc": bad2 / 2})
        for name, (seconds, bad2) in points.items()
    ]
    return Results(load_task("depth"), {cell.key: cell for cell in found}, None)


@pytest.mark.parametrize(
    "points",
    [
        {"same": (0.1, 5.0), "place": (0.1, 5.0)},
        {f"method {index}": (0.01 * 2**index, 20.0 - index) for index in range(15)},
        {"perfect": (1e-6, 0.0), "endless": (1e4, 100.0), "unknown": (1.0, float("nan"))},
    ],
    ids=["the same", "many", "extremes"],
)
def test_plot_has_a_panel_of_each_measure_and_of_the_curve(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, points):
    monkeypatch.setattr("tangible_bench.results.plot.DPI", 40)
    found, curve = results_at(points), load_task("depth").curve
    assert draw_plot(tmp_path / "plot.png", found) and curve is not None
    known = {**dict.fromkeys(curve.points.values(), 5.0), **dict.fromkeys(curve.ideal.values(), 1.0)}
    key, cell = next(iter(found.cells.items()))
    found.cells[key] = replace(cell, measures={**cell.measures, **known})
    assert draw_plot(tmp_path / "curve.png", found)
    assert [cv2.imread(str(tmp_path / name)).shape[1::-1] for name in ("plot.png", "curve.png")] == [
        (512, 192),
        (768, 192),
    ]


def test_plot_without_results_is_not_written(tmp_path: Path):
    failed = Cell("m", "s", "none", error="no")
    assert not draw_plot(tmp_path / "plot.png", Results(load_task("depth"), {failed.key: failed}, None))
    assert not list(tmp_path.iterdir())


def test_shortened_comparison_is_a_sixth_of_the_work_in_its_own_folder(registry: Registry, tmp_path: Path):
    whole = comparison(registry, tmp_path)
    short = shorten(whole)
    assert (short.protocol.repeats, short.protocol.calls, short.damages) == (1, 1, (Damage(),))
    assert short.out == tmp_path / "out-quick" and short.methods == whole.methods
    assert len(measurements(short)) * 6 == len(measurements(whole))


TEXT = """\
compare: depth
methods: [constant, {use: constant, label: "50 %_a", value_px: 5}, raises]
scenes: [{synthetic: steps, width_px: 64, height_px: 32}, {synthetic: bars, width_px: 64, height_px: 32}]
perturb: [none, {noise: 2}]
repeats: 3
warmups: 0
calls: 2
out: out
"""


def comparison(registry: Registry, folder: Path) -> Comparison:
    return parse_comparison(TEXT, folder / "c.yaml", registry)


def test_forecast_is_corrected_by_finished_measurements(tmp_path: Path):
    text = "compare: depth\nmethods: [semi-global, report]\nscenes: [{synthetic: steps}]\nrepeats: 2\n"
    waiting = look(
        measurements(parse_comparison(text, tmp_path / "c.yaml", default_registry())), tmp_path / "x"
    ).waiting
    guess = forecast(waiting)
    known = load_measured()["depth"].process_s
    assert guess.whole_s == pytest.approx(2 * (known["semi-global"] + known["report"]))
    once = tuple(replace(each, job=replace(each.job, warmups=0, calls=1)) for each in waiting)
    assert 0 < forecast(once).whole_s < guess.whole_s
    machine_of_half_the_speed = Forecast((2.0, 2.0, 4.0, 4.0))
    assert machine_of_half_the_speed.left_s(0, 0.0) == 12.0
    assert machine_of_half_the_speed.left_s(2, 8.0) == 16.0
    assert machine_of_half_the_speed.left_s(4, 24.0) == 0.0


@pytest.mark.usefixtures("cells_here")
def test_comparison_writes_every_figure_as_csv_and_latex(registry: Registry, tmp_path: Path):
    found = compare(shorten(comparison(registry, tmp_path)))
    assert {"table.csv", "table.tex", "results.jsonl"} <= {path.name for path in found.files}
    lines = list(csv.DictReader(io.StringIO((tmp_path / "out-quick" / "table.csv").read_text())))
    assert b"\r" not in (tmp_path / "out-quick" / "table.csv").read_bytes()
    assert len(lines) == 6
    known = {(each["method"], each["scene"].split()[0]): each for each in lines}
    assert len(known) == 6
    for cell in found.results.cells.values():
        (line,) = [each for each in lines if (each["method"], each["scene"]) == (cell.method, cell.scene)]
        if cell.error:
            assert "not this picture" in line["error"] and line["seconds"] == line["bad2"] == ""
        else:
            assert float(line["bad2"]) == cell.measures["bad2"] and float(line["seconds"]) == cell.seconds[0]
    latex = (tmp_path / "out-quick" / "table.tex").read_text()
    assert r"50 \%\_a" in latex and r"\midrule" in latex and latex.count(r"\\") == 4
    widths = {line.count("&") for line in latex.splitlines() if line.endswith(r"\\")}
    assert len(widths) == 1
    again = read_comparison(tmp_path / "out-quick" / "results.jsonl")
    assert set(again.files) == set(found.files)
