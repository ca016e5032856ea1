"""The forecast of a comparison, its short form, and its results as CSV and for LaTeX."""

import csv
import io
from dataclasses import replace
from pathlib import Path

import pytest

from tangible_bench.commands.progress import Forecast, forecast
from tangible_bench.comparing import compare, read_comparison
from tangible_bench.config.reading import Comparison, Damage, parse_comparison, shorten
from tangible_bench.measuring.plan import measurements
from tangible_bench.measuring.run import look
from tangible_core.metrics.measured import load_measured
from tangible_core.plugins.registry import Registry, default_registry

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


def test_shortened_comparison_is_a_sixth_of_the_work_in_its_own_folder(registry: Registry, tmp_path: Path):
    whole = comparison(registry, tmp_path)
    short = shorten(whole)
    assert (short.protocol.repeats, short.protocol.calls, short.damages) == (1, 1, (Damage(),))
    assert short.out == tmp_path / "out-quick" and short.methods == whole.methods
    assert len(measurements(short)) * 6 == len(measurements(whole))


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
