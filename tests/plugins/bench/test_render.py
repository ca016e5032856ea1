"""Force laws as a kind to compare: scenes by name, measures with exact answers, and a comparison from end to end."""

import math
from pathlib import Path

import cv2
import numpy as np
import pytest
from PIL import Image

from measuring_here import measure_here
from tangible_bench.config.reading import Comparison, parse_comparison
from tangible_bench.measuring.plan import measurements
from tangible_bench.measuring.run import look, run
from tangible_bench.metrics.stability import HANDLE
from tangible_bench.results.plot import draw_plot
from tangible_bench.results.summary import cells
from tangible_bench.results.table import Results, tables
from tangible_bench.strokes import SURFACES, KnownStroke, analytic_stroke
from tangible_bench.tasks.render import PERTURBATIONS, TASK, feel, limits, measure, prepare
from tangible_core.errors import ConfigError, OutputError
from tangible_core.plugins.registry import Registry, load_method
from tangible_core.servo.guard.safety import stiffness_limit_n_per_m
from tangible_core.session import Recording
from tangible_core.testing.synthetic.scenes import ramp

CELLS = 64
RISE = math.hypot(0.2, 0.1)
"""Slope of the ramp."""


@pytest.fixture(scope="module")
def strokes() -> dict[str, KnownStroke]:
    return {name: analytic_stroke(name, CELLS) for name in SURFACES}


def measure_method(name: str, stroke: KnownStroke, **options) -> dict[str, float]:
    method = load_method("render", name)(**options)
    return measure(feel(prepare(method, stroke), stroke), stroke)


def parse(text: str, registry: Registry) -> Comparison:
    return parse_comparison(text, Path("c.yaml"), registry)


def test_vertical_spring_has_known_errors_and_work(strokes):
    """The error is tan(t), the strength 1 / cos(t), the direction off by t; a loop in and out gives work k d dh."""
    found = measure_method("penalty", strokes["ramp"])
    assert found["error_percent"] == pytest.approx(100 * RISE, rel=1e-3)
    assert found["direction_deg"] == pytest.approx(math.degrees(math.atan(RISE)), rel=1e-3)
    assert found["jnd"] == pytest.approx(math.degrees(math.atan(RISE)) / 18, rel=1e-3)
    assert found["loop_work_j"] > 1e-3
    known = ramp((0.2, 0.0), shape=(CELLS, CELLS))
    across = np.linspace(-0.02, 0.02, 4001)
    along = np.array([known.at(x, 0.0, 0.001) for x in across])
    down, up = (np.linspace(*ends, 4001) for ends in (((-0.02, 0, 0.03), along[0]), (along[-1], (0.02, 0, 0.03))))
    way = np.vstack([down, along[1:-1], up])
    for path, work_j in ((way, 6.4e-3), (way[::-1], -6.4e-3)):
        stroke = KnownStroke(known.surface, path, np.full_like(path, np.nan))
        assert measure_method("penalty", stroke)["loop_work_j"] == pytest.approx(work_j, rel=2e-3)
        assert measure_method("penalty-gradient", stroke)["loop_work_j"] == pytest.approx(0, abs=1e-5)
        assert math.isnan(measure_method("penalty", stroke)["error_n"])


@pytest.mark.parametrize(("name", "percent"), [("plane", 1e-3), ("ramp", 1e-3), ("sphere", 1e-2), ("sine", 0.1)])
def test_proxy_equals_the_spring_to_the_nearest_point(strokes, name: str, percent: float):
    found = measure_method("proxy", strokes[name])
    assert found["error_percent"] < percent
    assert found["jnd"] < 0.01
    assert found["noticed_percent"] < 0.5
    assert found["lag_mm"] < 1e-3
    assert found["loop_work_j"] < 1e-5
    soft = measure_method("proxy", strokes[name], stiffness_n_per_m=200.0)
    assert soft["error_percent"] < percent, "the true spring is as stiff as the law's"


def test_laws_on_a_slope_lag_or_step_or_are_too_stiff(strokes):
    """The factor is sqrt(1 + s^2) along the gradient's force, and the same again along the normal."""
    found = measure_method("penalty-gradient", strokes["ramp"])
    assert found["error_percent"] == pytest.approx(100 * RISE**2, rel=1e-3)
    assert found["direction_deg"] == pytest.approx(0, abs=0.01)
    assert found["jnd"] == pytest.approx(RISE**2 / 0.07, rel=1e-3)
    assert measure_method("grey-level", strokes["plane"], force_at_white_n=2.0)["step_n"] == pytest.approx(2)
    fastest = np.linalg.norm(np.diff(strokes["plane"].position_m, axis=0), axis=1).max()
    assert measure_method("penalty", strokes["plane"])["step_n"] <= 800 * fastest
    circle = np.linspace(0, 2 * np.pi, 8001)
    way = np.column_stack([0.02 * np.cos(circle), 0.02 * np.sin(circle), np.full(8001, 0.009)])
    stroke = analytic_stroke("plane", CELLS, path_m=way)
    found = measure_method("proxy", stroke, static_friction=0.3, dynamic_friction=0.3)
    assert found["lag_mm"] == pytest.approx(0.3, rel=0.02)
    assert found["direction_deg"] == pytest.approx(math.degrees(math.atan(0.3)), rel=0.02)
    assert found["error_percent"] == pytest.approx(30, rel=0.02)
    assert math.isnan(found["loop_work_j"])


@pytest.mark.parametrize("name", ["penalty", "penalty-gradient", "force-shading", "proxy"])
def test_stiffness_limits_of_springs_equal_the_bound(strokes, name: str):
    method = load_method("render", name)()
    found = limits(method, strokes["plane"].surface)
    for delay in (0, 1, 2):
        bound = stiffness_limit_n_per_m(HANDLE.damping_n_s_per_m, HANDLE.period_s, delay)
        assert found[f"limit{delay}"] == pytest.approx(bound, rel=0.05)


def test_speed_takes_the_same_path_in_fewer_ticks(strokes):
    fast = PERTURBATIONS["speed"].apply(strokes["sine"], 9.0)
    assert len(fast.position_m) == 889
    np.testing.assert_array_equal(fast.position_m[5], strokes["sine"].position_m[45])
    np.testing.assert_array_equal(fast.nearest_m[5], strokes["sine"].nearest_m[45])
    assert fast.period_s == strokes["sine"].period_s


@pytest.mark.parametrize("bits", [1, 8, 16])
def test_bits_round_heights_to_n_levels(strokes, bits: int):
    changed = PERTURBATIONS["bits"].apply(strokes["sine"], float(bits))
    heights, before = changed.surface.height_m, strokes["sine"].surface.height_m
    assert np.unique(heights).size <= 2**bits
    assert np.abs(heights - before).max() <= before.max() / (2**bits - 1) / 2 * 1.001
    assert heights.max() == pytest.approx(before.max())
    np.testing.assert_array_equal(changed.nearest_m, strokes["sine"].nearest_m)


def recording(count: int = 50) -> Recording:
    way = np.column_stack([np.linspace(-0.01, 0.01, count), np.zeros(count), np.full(count, 0.009)])
    rest = np.zeros((count, 3))
    return Recording.of(time_s=np.arange(count) * 0.002, position_m=way, velocity_m_per_s=rest, force_n=rest)


def test_stiffness_limits_of_other_force_laws_are_unknown(strokes):
    for name, scene in (("grey-level", "plane"), ("penalty", "ramp")):
        found = limits(load_method("render", name)(), strokes[scene].surface)
        assert list(found) == ["limit0", "limit1", "limit2"] and all(map(math.isnan, found.values()))


@pytest.mark.parametrize(("kind", "value"), [("speed", 1.0), ("speed", 2.5), ("bits", 0.0), ("bits", 17.0)])
def test_invalid_perturbation_is_not_allowed(kind: str, value: float):
    assert not PERTURBATIONS[kind].is_valid(value)


def test_scene_names_give_their_options(registry: Registry, tmp_path: Path):
    picture = tmp_path / "map.png"
    Image.fromarray(np.arange(64 * 48, dtype=np.uint8).reshape(48, 64)).save(picture)
    given = f"analytic/sphere, {{analytic: step, cells: 64, depth_m: 0.0005}}, {{height: {picture}, relief_m: 0.005}}"
    scenes = parse(f"compare: render\nmethods: [proxy]\nscenes: [{given}, builtin/motorcycle]\n", registry).scenes
    assert list(scenes) == [
        "sphere 256x256, 1 mm deep",
        "step 64x64, 0.5 mm deep",
        "map.png 80 mm wide, 5 mm high, 1 mm deep",
        "builtin/motorcycle 80 mm wide, 10 mm high, 1 mm deep",
    ]
    relief, built = (scene.open().surface for scene in list(scenes.values())[2:])
    assert (relief.height_m.max(), relief.extent_m) == (np.float32(0.005), (0.08, 0.06))
    assert built.height_m[250, 370] > built.height_m[30, 30], "nearer than the wall, so it stands out"


@pytest.mark.parametrize(
    ("scene", "what"),
    [
        ("sphere", "analytic/sphere"),
        ("analytic/cube", "'plane', 'ramp'"),
        ("{analytic: cone, builtin: coins}", "analytic and builtin"),
        ("{analytic: cone, relief_m: 0.02}", "relief_m"),
        ("{builtin: coins, cells: 64}", "cells"),
    ],
)
def test_invalid_scene_is_refused(registry: Registry, scene: str, what: str):
    with pytest.raises(ConfigError, match=what):
        parse(f"compare: render\nmethods: [proxy]\nscenes: [{scene}]\n", registry)


def test_recording_gives_the_path_of_the_scene(tmp_path: Path, registry: Registry):
    def record(count: int) -> np.ndarray:
        way = np.column_stack([np.linspace(-0.01, 0.01, count), np.zeros(count), np.full(count, 0.009)])
        rest, time_s = np.zeros((count, 3)), np.arange(count) * 0.002
        Recording.of(time_s=time_s, position_m=way, velocity_m_per_s=rest, force_n=rest).save(tmp_path / "hand.npz")
        return way

    way = record(50)
    text = "compare: render\nmethods: [proxy]\nscenes: [{analytic: plane, cells: 64, recording: hand.npz}]\n"
    ((name, scene),) = parse_comparison(text, tmp_path / "c.yaml", registry).scenes.items()
    assert name == "plane 64x64, hand.npz"
    stroke = scene.open()
    np.testing.assert_array_equal(stroke.position_m, way)
    assert stroke.period_s == pytest.approx(0.002)
    assert measure_method("penalty", stroke)["error_percent"] == pytest.approx(0, abs=1e-3)
    for count in (0, 1):
        record(count)
        with pytest.raises(OutputError, match="two finite positions"):
            scene.open()


@pytest.fixture(scope="module")
def comparison_results(tmp_path_factory: pytest.TempPathFactory) -> Results:
    text = """\
compare: render
methods: [penalty, grey-level]
scenes: [{analytic: ramp, cells: 64}, builtin/coins]
perturb: [{speed: 9}]
repeats: 1
warmups: 0
calls: 1
"""
    wanted = measurements(parse(text, Registry()))
    path = tmp_path_factory.mktemp("compared") / "r.jsonl"
    with pytest.MonkeyPatch.context() as patch:
        measure_here(patch)
        rows = run(look(wanted, path), path, 120, lambda *_: None, lambda *_: None).values()
    assert {row.error for row in rows} == {None}
    return Results(TASK, cells(rows, None), None)


def test_render_comparison_has_exact_results_and_plots(
    comparison_results: Results, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    """The truth of the coins is unknown, so the error is that of the ramp alone."""
    (means,) = tables(comparison_results)
    assert means.headings[:6] == ("method", "*", "ns a tick", "peak MB", "error %", "error N")
    assert [row[0] for row in means.rows] == ["penalty", "grey-level"]
    assert float(means.rows[0][4]) == pytest.approx(100 * RISE, abs=0.01)
    seconds = [cell.seconds for cell in comparison_results.cells.values() if cell.method == "penalty"]
    assert min(map(min, seconds)) <= float(means.rows[0][2]) * 1e-9 <= max(map(max, seconds)) * 1.001
    monkeypatch.setattr("tangible_bench.results.plot.DPI", 40)
    coins = {key: cell for key, cell in comparison_results.cells.items() if "coins" in cell.scene}
    assert draw_plot(tmp_path / "all.png", comparison_results)
    assert draw_plot(tmp_path / "coins.png", Results(TASK, coins, None))
    widths = [cv2.imread(str(tmp_path / name)).shape[1] for name in ("all.png", "coins.png")]
    assert widths == [3 * 256, 256]
