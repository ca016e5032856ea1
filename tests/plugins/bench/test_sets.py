"""Standard sets in comparisons: scenes, measures, the tables of papers, and folders to submit."""

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
from tangible_bench.datasets import MarkedPair, StandardPair
from tangible_bench.datasets.submissions import write_pfm, write_png16, write_submission
from tangible_bench.measuring.rows import Row, append
from tangible_bench.results import set_tables
from tangible_bench.results.summary import cells
from tangible_bench.results.table import Results, tables
from tangible_bench.submitting import submit
from tangible_bench.tasks.depth import TASK, measure, range_px
from tangible_bench.tasks.depth_scenes import DepthScene
from tangible_bench.tasks.texture_scenes import TextureScene
from tangible_core.data import DisparityMap
from tangible_core.errors import ConfigError, OutputError, PictureError
from tangible_core.plugins.registry import Registry
from tangible_core.scene.formats.pictures import read_map, read_truth


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
        ("{set: kitti-2015}", ["kitti-2015/000000_10"]),
        ("kitti-2015", ["kitti-2015/000000_10"]),
        ("kitti-2015@test", ["kitti-2015@test/000000_10"]),
        ("{set: kitti-2015, only: [000000_10]}", ["kitti-2015/000000_10"]),
        ("{set: middlebury-eval3, folder: middlebury-eval3}", ["middlebury-eval3@Q/Adirondack"]),
        ("{set: middlebury-2014, resolution: Q}", ["middlebury-2014@Q/Adirondack-perfect"]),
        ("middlebury-2014@H", ["middlebury-2014@H/Adirondack-perfect"]),
        ("middlebury-2014", ["middlebury-2014/Adirondack-perfect"]),
        ("{set: middlebury-eval3, split: test}", ["middlebury-eval3@Q@test/Australia"]),
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
        ("kitti-2016", "no scene is named 'kitti-2016'"),
        ("{set: eth3d, folder: nowhere}", "nowhere: there is no such folder; fetch two_view_training.7z"),
        ("{set: kitti-2015, resolution: Q}", "resolution: kitti-2015 has none called 'Q'"),
        ("{set: kitti-2015, builtin: motorcycle}", "this one is builtin and set"),
        ("{folder: x, resolution: Q}", "resolution needs a standard set; name it: `set: ...`"),
        ("{set: kitti-2015, only: [x]}", "no pair in it is named 'x'"),
        ("{pairs: {left: 'L*', right: 'R*'}}", "no file in it matches left: 'L*'"),
        ("{pairs: {left: 'L*'}}", "scenes.0.pairs.right: Field required"),
    ],
)
def test_set_with_a_mistake_is_refused_with_its_place(scene: str, why: str, registry: Registry, folder: Path):
    with pytest.raises(ConfigError) as error:
        parse(registry, folder, scene)
    said = str(error.value)
    assert why in said and "c.yaml:3:" in said and "\n" not in said


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


def test_custom_pictures_and_labels_are_matched_by_their_stars(tmp_path: Path):
    for name in ("x", "y"):
        put(tmp_path / f"pictures/{name}.png", np.arange(12, dtype=np.uint8).reshape(3, 4))
        put(tmp_path / f"truth/{name}_seg.png", np.eye(3, 4, dtype=np.uint8))
    spec = TextureScene.model_validate(
        {"folder": tmp_path, "pairs": {"picture": "pictures/*.png", "labels": "truth/*_seg.png"}}
    )
    assert list(spec.expand()) == ["x", "y"]
    scene = spec.expand()["y"].open()
    assert scene.count == 2 and scene.labels.shape == (3, 4)
    again = TextureScene.model_validate(spec.expand()["y"].model_dump(mode="json"))
    assert again.open().digest() == scene.digest()
    put(tmp_path / "truth/y_seg.png", np.eye(4, 4, dtype=np.uint8))
    with pytest.raises(PictureError, match=r"y\.png is 4 x 3 and .*y_seg\.png 4 x 4; they must be of the same size"):
        again.open()


class TestMeasures:
    def pair(self, folder: Path, scene: dict[str, object]) -> MarkedPair:
        (spec,) = DepthScene.model_validate({**scene, "folder": folder / str(scene["set"])}).expand().values()
        found = spec.open()
        assert isinstance(found, MarkedPair)
        return found

    def test_thresholds_count_pixels_of_the_full_size(self, folder: Path):
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

    def test_noc_measures_use_the_mask_of_the_set(self, folder: Path):
        pair = self.pair(folder, {"set": "kitti-2015"})
        wrong = np.where(pair.noc, np.nan_to_num(pair.truth_px), 99).astype(np.float32)
        figures = measure(DisparityMap(wrong), pair)
        assert figures["d1_noc"] == figures["bad3_noc"] == 0 < figures["d1"] == figures["bad3"]
        assert figures["pixels_bg"] + figures["pixels_fg"] == figures["pixels"] > figures["pixels_noc"]

    def test_sparse_truth_without_a_mask_has_no_noc_measures(self, folder: Path):
        pair = replace(self.pair(folder, {"set": "kitti-2015"}), noc=None)
        figures = measure(DisparityMap(np.zeros(pair.views.shape, np.float32)), pair)
        assert figures["bad2"] > 0 and not [name for name in figures if name.endswith("_noc")]

    def test_estimates_are_clipped_to_the_range_of_the_set(self, folder: Path):
        pair = self.pair(folder, {"set": "middlebury-2014"})
        truth = np.full(pair.views.shape, 19.5, np.float32)
        figures = measure(DisparityMap(np.full(pair.views.shape, 500.0, np.float32)), replace(pair, truth_px=truth))
        assert figures["average_px"] == 0.5 and figures["bad0.5"] == 0

    def test_range_for_methods_follows_the_set(self, folder: Path):
        assert range_px(self.pair(folder, {"set": "middlebury-2014"})) == 32
        assert range_px(self.pair(folder, {"set": "kitti-2015"})) == 16
        assert range_px(self.pair(folder, {"set": "kitti-2015", "split": "test"})) == 256

    def test_measures_all_have_a_heading(self, folder: Path):
        pair = self.pair(folder, {"set": "middlebury-eval3"})
        figures = measure(DisparityMap(np.zeros(pair.views.shape, np.float32)), pair)
        assert {name for name in figures if not name.startswith("pixels")} <= set(TASK.measures)
        columns = {each.measure for columns in set_tables.COLUMNS.values() for each in columns}
        assert columns <= set(TASK.measures)


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
    values = dict(zip((each.heading for each in table.columns), table.rows["m"], strict=True))
    assert (values["D1-fg all"], values["D1-all all"]) == (20.0, 6.5)
    assert table.title == "KITTI 2015, 3 pairs"


def test_set_table_has_the_benchmark_order_and_bold_best():
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


def test_set_table_leaves_out_a_method_without_a_pair():
    found = results(
        row("m", "eth3d/a", bad1_noc=1.0),
        row("m", "eth3d/b", bad1_noc=2.0),
        row("n", "eth3d/a", bad1_noc=0.5),
        replace(row("n", "eth3d/b"), seconds=None, error="no"),
    )
    (table,) = set_tables.set_tables(found)
    assert list(table.rows) == ["m"] and 1.5 in table.rows["m"]


def test_headings_name_the_size_of_pixels():
    def headings(*scenes: str) -> tuple[str, ...]:
        return tables(results(*(row("m", scene, bad2=1.0) for scene in scenes)), detail=False)[0].headings

    assert "bad2@Q %" in headings("builtin/motorcycle")
    assert "bad2@H noc %" in headings("middlebury-2014@H/a", "middlebury-2014@H/b")
    assert results(row("m", "builtin/motorcycle")).heading("bad2") == "bad2@Q %"
    for scenes in (["kitti-2015/a"], ["builtin/motorcycle", "synthetic"], ["middlebury-2014/a"]):
        assert "bad2 %" in headings(*scenes)


def test_detail_tables_have_benchmark_measures_for_sets_only():
    old = tables(results(row("m", "planes 64x32", bad2=1.0)), detail=True)[1]
    assert old.headings[4:] == tuple(each.title for each in TASK.measures.values() if not each.of_sets)
    assert len(old.headings) == 20 and "A90 px" not in old.headings
    new = tables(results(row("m", "kitti-2015/a", bad2=1.0, d1=2.0)), detail=True)[1]
    assert new.headings[-1] == "D1-all %"


class TestSubmissions:
    def submit_files(self, registry: Registry, folder: Path, scenes: str, methods: str = "half") -> dict[str, Path]:
        comparison = parse(registry, folder, scenes, methods)
        found = list(submit(comparison, folder / "sent"))
        assert not [each.error for each in found if each.error]
        return {str(path.relative_to(folder / "sent")): path for each in found for path in each.files}

    def test_middlebury_submission_has_the_layout_of_its_kit(self, registry: Registry, folder: Path):
        files = self.submit_files(
            registry, folder, "middlebury-eval3, middlebury-eval3@test", "{use: half, label: my half}"
        )
        assert list(files) == [
            "my-half/trainingQ/Adirondack/disp0my-half.pfm", "my-half/trainingQ/Adirondack/timemy-half.txt",
            "my-half/testQ/Australia/disp0my-half.pfm", "my-half/testQ/Australia/timemy-half.txt",
        ]  # fmt: skip
        first, time = list(files.values())[:2]
        found = read_map(first)
        assert (found[:, :48] == 4).all() and np.isnan(found[:, 48:]).all()
        assert b"\x00\x00\x80\x7f" in first.read_bytes(), "unknown is infinite"
        assert 0 < float(time.read_text()) < 60

    def test_kitti_submission_has_the_layout_of_its_kit(self, registry: Registry, folder: Path):
        files = self.submit_files(registry, folder, "kitti-2015@test, kitti-2012@test", "{use: half, value_px: 4.126}")
        assert list(files) == ["half/disp_0/000000_10.png", "half/000000_10.png"]
        for path in files.values():
            assert path.read_bytes()[24] == 16, "bits"
            found = read_truth(path, 256)
            assert np.isnan(found[:, 48:]).all() and np.abs(found[:, :48] - 4.126).max() <= 1 / 512

    def test_eth3d_submission_has_the_layout_of_its_kit(self, registry: Registry, folder: Path):
        files = self.submit_files(registry, folder, "eth3d")
        assert list(files) == [
            "half/low_res_two_view/delivery_area_1l.pfm", "half/low_res_two_view/delivery_area_1l.txt"
        ]  # fmt: skip
        found, time = files.values()
        assert (read_map(found)[:, :48] == 4).all()
        word, seconds = time.read_text().split()
        assert word == "runtime" and float(seconds) > 0

    @pytest.mark.parametrize("shape", [(1, 1), (3, 5)])
    def test_float_map_is_read_as_it_was_written(self, shape: tuple[int, int], tmp_path: Path):
        values = np.random.default_rng(3).normal(0, 1e3, shape).astype(np.float32)
        values[-1, 0] = np.nan
        write_pfm(tmp_path / "d.pfm", values)
        np.testing.assert_array_equal(read_map(tmp_path / "d.pfm"), values)
        assert (tmp_path / "d.pfm").read_bytes().startswith(f"Pf\n{shape[1]} {shape[0]}\n-1.0\n".encode())

    def test_png16_clips_values_to_16_bits(self, tmp_path: Path):
        values = np.float32([[0, -3, 1e-4, 255.99, 300, np.nan, np.inf]])
        write_png16(tmp_path / "d.png", values)
        stored = read_map(tmp_path / "d.png")
        np.testing.assert_array_equal(stored, [[1, 1, 1, 65533, 65535, 0, 0]])

    def test_submission_reports_failing_methods_and_continues(self, registry: Registry, folder: Path):
        found = list(submit(parse(registry, folder, "eth3d", "raises, fails, relative, constant"), folder / "sent"))
        errors = {each.method: each.error for each in found}
        assert errors["raises"] == "not this picture" and "relative" in errors["relative"]
        assert errors["fails"] and not errors["constant"]
        assert [path.name for path in (folder / "sent").iterdir()] == ["constant"]

    def test_submission_on_a_full_disk_leaves_no_partial_file(self, registry: Registry, folder: Path, monkeypatch):
        monkeypatch.setattr("tangible_core.files.writing.os.fdopen", _full)
        with pytest.raises(OutputError, match="No space left"):
            list(submit(parse(registry, folder, "eth3d"), folder / "sent"))
        assert not [path for path in (folder / "sent").rglob("*") if path.is_file()]

    def test_set_without_submissions_is_refused(self, registry: Registry, folder: Path):
        with pytest.raises(ConfigError, match="no scene is from a set that takes submissions: middlebury-eval3"):
            list(submit(parse(registry, folder, "{synthetic: steps}"), folder / "sent"))
        pair = StandardPair("x", Path("l.png"), Path("r.png"))
        with pytest.raises(ConfigError, match="sintel takes no submissions; sets that do are middlebury-eval3"):
            write_submission(folder, "sintel", "m", pair, np.zeros((1, 1), np.float32), 1.0)


def _full(handle: int, mode: str):
    raise OSError(28, "No space left on device")


class TestCommand:
    @pytest.fixture(autouse=True)
    def use_registry(self, registry: Registry, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.setattr("tangible_core.plugins.registry.default_registry", lambda: registry)

    @pytest.mark.usefixtures("cells_here")
    def test_command_measures_a_set_by_its_name(self, registry: Registry, folder: Path):
        methods = "methods=[constant, {use: constant, label: other, value_px: 2}]"
        words = ("compare", "kitti-2015", "--set", methods, "--set", "warmups=0")
        done = tangible(*words, cwd=folder)
        assert done.returncode == 0, done.stderr
        assert "KITTI 2015, 1 pair" in done.stdout and "D1-all" in done.stdout
        out = folder / "out" / "kitti-2015"
        for name in ("results.jsonl", "table.csv", "table.tex", "kitti-2015.csv", "kitti-2015.tex"):
            assert (out / name).is_file() and str(Path("out", "kitti-2015", name)) in done.stdout
        rows = list(csv.DictReader((out / "kitti-2015.csv").read_text().splitlines()))
        assert {each["method"] for each in rows} == {"constant", "other"}
        assert all(0 <= float(each["D1-all noc"]) <= 100 for each in rows)
        for form, file in (("latex", "kitti-2015.tex"), ("csv", "kitti-2015.csv")):
            again = tangible("compare", out / "results.jsonl", "--table", form, cwd=folder)
            assert again.stdout == (out / file).read_text()

    def test_command_with_a_missing_set_reports_one_line(self, tmp_path: Path):
        done = tangible("compare", "eth3d", cwd=tmp_path)
        assert done.returncode == 2 and done.stderr.count("\n") == 1
        assert f"{tmp_path / 'eth3d'}: there is no such folder; fetch two_view_training.7z" in done.stderr

    def test_command_writes_submissions(self, registry: Registry, folder: Path):
        (folder / "elsewhere").symlink_to(folder / "eth3d")
        words = ("compare", "eth3d", "--folder", "elsewhere", "--submission", "sent")
        done = tangible(*words, "--set", "methods=[half]", cwd=folder)
        assert done.returncode == 0, done.stderr
        assert "half: 2 files in sent" in done.stdout and not (folder / "out").exists()
        done = tangible(*words, "--set", "methods=[half, raises]", cwd=folder)
        assert done.returncode == 1
        assert "no result of raises on eth3d/delivery_area_1l: not this picture" in done.stderr

    def test_command_prints_the_means_of_other_scenes(self, tmp_path: Path):
        append(tmp_path / "r.jsonl", row("m", "planes 64x32", bad2=1.0))
        done = tangible("compare", "r.jsonl", "--table", "latex", cwd=tmp_path)
        assert done.stdout == (tmp_path / "table.tex").read_text()

    @pytest.mark.parametrize(
        ("words", "why"),
        [
            (["c.yaml", "--folder", "x"], "--folder: is the folder of a standard set, and c.yaml is not one"),
            (["r.jsonl", "--submission", "x"], "--submission: r.jsonl holds figures alone; name the comparison file"),
            (["c.yaml", "--table", "csv", "--json"], "--table: decides what is printed"),
            (["kitti-2015@X"], "resolution: kitti-2015 has none called 'X'"),
        ],
    )
    def test_command_with_conflicting_options_exits_with_2(self, words: list[str], why: str, folder: Path):
        done = tangible("compare", *words, cwd=folder)
        assert done.returncode == 2 and why in done.stderr and done.stderr.count("\n") == 1
