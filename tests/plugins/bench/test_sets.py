"""Standard sets in comparisons: scenes, measures, and the tables of papers."""

import csv
import io
import math
import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from command_line import tangible
from standard_sets import LAYOUTS, known, put
from tangible_bench.config.reading import Comparison, parse_comparison
from tangible_bench.datasets import MarkedPair
from tangible_bench.measuring.rows import Row, append
from tangible_bench.results import set_tables
from tangible_bench.results.summary import cells
from tangible_bench.results.table import Results
from tangible_bench.tasks.depth import TASK, measure, range_px
from tangible_bench.tasks.depth_scenes import DepthScene
from tangible_core.data import DisparityMap
from tangible_core.errors import ConfigError
from tangible_core.plugins.registry import Registry


@pytest.fixture(scope="module")
def sets(tmp_path_factory: pytest.TempPathFactory) -> Path:
    made = tmp_path_factory.mktemp("sets")
    for name in ("kitti-2015", "middlebury-eval3", "middlebury-2014", "eth3d", "kitti-2012"):
        LAYOUTS[name].make(made / name, known())
    return made


@pytest.fixture
def folder(tmp_path: Path, sets: Path) -> Path:
    return Path(shutil.copytree(sets, tmp_path, dirs_exist_ok=True))


def parse(registry: Registry, folder: Path, scenes: str, methods: str = "constant", more: str = "") -> Comparison:
    text = f"compare: depth\nmethods: [{methods}]\nscenes: [{scenes}]\nrepeats: 1\nwarmups: 0\ncalls: 1\n{more}"
    return parse_comparison(text, folder / "c.yaml", registry)


@pytest.mark.parametrize(
    ("scene", "names"),
    [
        ("kitti-2015", ["kitti-2015/000000_10"]),
        ("{set: kitti-2015, only: [000000_10]}", ["kitti-2015/000000_10"]),
        ("{set: middlebury-eval3, split: test}", ["middlebury-eval3@Q@test/Australia"]),
        ("{set: middlebury-2014, resolution: Q}", ["middlebury-2014@Q/Adirondack-perfect"]),
        ("middlebury-2014@H, middlebury-2014", [f"middlebury-2014{at}/Adirondack-perfect" for at in ("@H", "")]),
        ("kitti-2015, kitti-2015@test", ["kitti-2015/000000_10", "kitti-2015@test/000000_10"]),
    ],
)
def test_set_expands_to_its_pairs(scene: str, names: list[str], registry: Registry, folder: Path):
    comparison = parse(registry, folder, scene)
    assert list(comparison.scenes) == names
    for spec in comparison.scenes.values():
        again = DepthScene.model_validate(spec.model_dump(mode="json"))
        assert again.open().digest() == spec.open().digest(), "a process of its own opens the same pair"


@pytest.mark.parametrize(
    ("scene", "why"),
    [
        ("kitti-2016", "'kitti-2016'"),
        ("{set: eth3d, folder: nowhere}", "two_view_training.7z"),
        ("{set: kitti-2015, builtin: motorcycle}", "builtin and set"),
        ("{folder: x, resolution: Q}", "`set: ...`"),
        ("{pairs: {left: 'L*', right: 'R*'}}", "left: 'L*'"),
        ("{pairs: {left: 'L*'}}", "scenes.0.pairs.right"),
    ],
)
def test_set_with_a_mistake_is_refused_with_its_place(scene: str, why: str, registry: Registry, folder: Path):
    with pytest.raises(ConfigError) as error:
        parse(registry, folder, scene)
    assert why in str(error.value) and "c.yaml:3:" in str(error.value)


def test_custom_pairs_are_matched_by_their_stars(registry: Registry, tmp_path: Path):
    k = known()
    for name in ("a", "b"):
        put(tmp_path / "mine" / name / "L.png", k.pair.views.left)
        put(tmp_path / "mine" / name / "R.png", k.pair.views.right)
    put(tmp_path / "mine/a/D.png", np.rint(64 * np.nan_to_num(k.truth_px)).astype(np.uint16))
    put(tmp_path / "mine/a/N.png", np.where(k.visible, 255, 0).astype(np.uint8))
    globs = "{left: 'mine/*/L.png', right: 'mine/*/R.png', truth: 'mine/*/D.png', truth_scale: 64, noc: 'mine/*/N.png'}"
    comparison = parse(registry, tmp_path, f"{{pairs: {globs}}}")
    assert list(comparison.scenes) == ["a", "b"]
    first, second = (spec.open() for spec in comparison.scenes.values())
    assert np.nanmax(np.abs(first.truth_px - k.truth_px)) <= 1 / 128 + 1e-6
    np.testing.assert_array_equal(first.noc, k.visible)
    assert isinstance(second, MarkedPair) and second.truth_px is None
    assert measure(DisparityMap(np.zeros(second.views.shape, np.float32)), second) == {}


class TestMeasures:
    def pair(self, folder: Path, scene: dict[str, object]) -> MarkedPair:
        (spec,) = DepthScene.model_validate({**scene, "folder": folder / str(scene["set"])}).expand().values()
        found = spec.open()
        assert isinstance(found, MarkedPair)
        return found

    def test_measures_use_the_full_size_and_the_mask_of_the_set(self, folder: Path):
        """bad2 of a quarter of the size is what tables call bad8, and their bad2 is its bad0.5."""
        pair = self.pair(folder, {"set": "middlebury-eval3"})
        random = np.random.default_rng(1)
        found = (np.nan_to_num(pair.truth_px) + random.normal(0, 1, pair.truth_px.shape)).astype(np.float32)
        figures = measure(DisparityMap(found), pair)
        for end in ("", "_noc"):
            assert figures[f"bad2_full{end}"] == figures[f"bad0.5{end}"]
            assert figures[f"bad4_full{end}"] == figures[f"bad1{end}"]
            assert figures[f"average_px_full{end}"] == pytest.approx(4 * figures[f"average_px{end}"], rel=1e-5)
            assert figures[f"a90_px_full{end}"] == pytest.approx(4 * figures[f"a90_px{end}"], rel=1e-5)
        assert figures["bad2"] < figures["bad1"] < figures["bad0.5"] < 100
        pair = self.pair(folder, {"set": "kitti-2015"})
        wrong = np.where(pair.noc, np.nan_to_num(pair.truth_px), 99).astype(np.float32)
        figures = measure(DisparityMap(wrong), pair)
        assert figures["d1_noc"] == figures["bad3_noc"] == 0 < figures["d1"] == figures["bad3"]
        assert figures["pixels_bg"] + figures["pixels_fg"] == figures["pixels"] > figures["pixels_noc"]
        without = measure(DisparityMap(wrong), replace(pair, noc=None))
        assert without["bad2"] > 0 and not [name for name in without if name.endswith("_noc")]

    def test_estimates_and_ranges_follow_the_set(self, folder: Path):
        pair = self.pair(folder, {"set": "middlebury-2014"})
        truth, found = np.full(pair.views.shape, 19.5, np.float32), np.full(pair.views.shape, 500.0, np.float32)
        assert measure(DisparityMap(found), replace(pair, truth_px=truth))["average_px"] == 0.5
        assert range_px(self.pair(folder, {"set": "middlebury-2014"})) == 32
        assert range_px(self.pair(folder, {"set": "kitti-2015"})) == 16
        assert range_px(self.pair(folder, {"set": "kitti-2015", "split": "test"})) == 256


def row(method: str, scene: str, **measures: float) -> Row:
    return Row(
        f"{method} {scene}", "depth", method, method, {}, "x 1", scene, "d", "none", (), 0, {}, {}, None, 1.0, 1.0, 1,
        measures,
    )  # fmt: skip


def results(*rows: Row) -> Results:
    return Results(TASK, cells(rows, None), None)


def test_kitti_measures_are_weighted_by_pixels():
    """A pair without a foreground has no part in that of the others."""
    found = results(
        row("m", "kitti-2015/a", d1_fg=10.0, pixels_fg=300.0, d1=5.0, pixels=1000.0),
        row("m", "kitti-2015/b", d1_fg=50.0, pixels_fg=100.0, d1=7.0, pixels=3000.0),
        row("m", "kitti-2015/c", d1_fg=math.nan, pixels_fg=0.0, d1=6.5, pixels=0.0),
    )
    (table,) = set_tables.set_tables(found)
    values = dict(zip((column.heading for column in table.columns), table.rows["m"], strict=True))
    assert (values["D1-fg all"], values["D1-all all"]) == (20.0, 6.5)
    assert table.title == "KITTI 2015, 3 pairs"


def test_set_table_has_the_benchmark_order_and_whole_methods_alone():
    at = "middlebury-eval3@Q/x"
    found = results(
        row("one_a", at, bad2_full_noc=9.25, bad2_full=30.0),
        row("two", at, bad2_full_noc=4.5, bad2_full=40.0),
        row("none", at),
    )
    (table,) = set_tables.set_tables(found)
    assert list(table.rows) == ["two", "one_a"]
    latex = set_tables.as_latex(table)
    assert latex.startswith("% Middlebury v3 Q, 1 pair. Needs \\usepackage{booktabs}.\n\\begin{tabular}{lrr")
    lines = latex.splitlines()
    assert lines[5].startswith("two & - & - & \\textbf{4.50} & ") and "\\textbf{30.00}" in lines[6]
    assert lines[6].startswith("one\\_a & ") and lines[-2:] == ["\\bottomrule", "\\end{tabular}"]
    (first, *rest) = csv.DictReader(io.StringIO(set_tables.as_csv(table)))
    assert first["method"] == "two" and float(first["bad 2 noc"]) == 4.5 and first["bad 4 noc"] == ""
    assert len(rest) == 1
    found = results(
        row("m", "eth3d/a", bad1_noc=1.0),
        row("m", "eth3d/b", bad1_noc=2.0),
        row("n", "eth3d/a", bad1_noc=0.5),
        replace(row("n", "eth3d/b"), seconds=None, error="no"),
    )
    (table,) = set_tables.set_tables(found)
    assert list(table.rows) == ["m"] and 1.5 in table.rows["m"]


class TestCommand:
    @pytest.fixture(autouse=True)
    def use_registry(self, registry: Registry, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.setattr("tangible_core.plugins.registry.default_registry", lambda: registry)

    @pytest.mark.usefixtures("cells_here")
    def test_command_measures_a_set_by_its_name(self, folder: Path):
        methods = "methods=[constant, {use: constant, label: other, value_px: 2}]"
        done = tangible("compare", "kitti-2015", "--set", methods, "--set", "warmups=0", cwd=folder)
        assert done.returncode == 0, done.stderr
        assert "KITTI 2015, 1 pair" in done.stdout and "D1-all" in done.stdout
        out = folder / "out" / "kitti-2015"
        rows = list(csv.DictReader((out / "kitti-2015.csv").read_text().splitlines()))
        assert {each["method"] for each in rows} == {"constant", "other"}
        assert all(0 <= float(each["D1-all noc"]) <= 100 for each in rows)
        for form, end in (("latex", "tex"), ("csv", "csv")):
            again = tangible("compare", out / "results.jsonl", "--table", form, cwd=folder)
            assert again.stdout == (out / f"kitti-2015.{end}").read_text()
        append(folder / "r.jsonl", row("m", "planes 64x32", bad2=1.0))  # of no set: the means
        done = tangible("compare", "r.jsonl", "--table", "latex", cwd=folder)
        assert done.stdout == (folder / "table.tex").read_text()

    @pytest.mark.parametrize(
        ("words", "why"),
        [
            (["c.yaml", "--folder", "x"], "--folder"),
            (["c.yaml", "--table", "csv", "--json"], "--table"),
            (["kitti-2015@X"], "'X'"),
        ],
    )
    def test_command_with_conflicting_options_exits_with_2(self, words: list[str], why: str, folder: Path):
        done = tangible("compare", *words, cwd=folder)
        assert done.returncode == 2 and why in done.stderr and done.stderr.count("\n") == 1
