"""The plot: drawn, legible, and without overlaps."""

from dataclasses import replace
from pathlib import Path

import cv2
import pytest

from tangible_bench.results.plot import draw_plot
from tangible_bench.results.summary import Cell
from tangible_bench.results.table import Results
from tangible_bench.tasks.task import load_task


def results(points: dict[str, tuple[float, float]]) -> Results:
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
    found, curve = results(points), load_task("depth").curve
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
