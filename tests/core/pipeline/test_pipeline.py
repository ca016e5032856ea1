"""The package in Python. Otherwise a program could not do what a file says and a command does, or would hang."""

import threading
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from tangible_core import Calibration, DisparityMap, Pipeline, Recording, Scene, Views, Workspace, load_method, show
from tangible_core.data import TICK_COLUMNS
from tangible_core.errors import ArgumentError, ConfigError, OutputError, Stopped
from tangible_core.pipeline.engine.stage import StageEvent
from tangible_core.pipeline.feeling import Feeling
from tangible_core.pipeline.starter import suited_config
from tangible_core.plugins import DepthEstimator
from tangible_core.plugins.registry import default_registry
from tangible_core.session import STOPPED, compare_replay
from tangible_depth import Luminance, SemiGlobal, Zncc
from tangible_devices import Mock
from tangible_render import Penalty, Proxy
from tangible_texture import Gabor, Histogram

SHAPE = 48, 64


def pair() -> tuple[np.ndarray, np.ndarray]:
    """Noise shifted by 3 px, RGB."""
    right = np.random.default_rng(0).integers(0, 256, (*SHAPE, 3)).astype(np.uint8)
    return np.roll(right, 3, axis=1), right


class Flat(DepthEstimator):
    """A depth method of one disparity everywhere, in no entry point."""

    value_px: float = 3.0
    """The disparity everywhere, px."""

    def estimate(self, views: Views) -> DisparityMap:
        return DisparityMap(np.full(views.shape, self.value_px, np.float32))


class Slow(DepthEstimator):
    """Goes on until it is stopped."""

    def estimate(self, views: Views) -> DisparityMap:
        from tangible_core.compiled.threads import in_turns

        while True:
            in_turns(list(range(4)), list)


def test_pipeline_plans_makes_runs_and_feels(tmp_path: Path):
    left, right = pair()
    pipeline = Pipeline(
        Scene.pair(left, right, calibration=Calibration(994.978, 0.193, 31.086)),
        depth=SemiGlobal(),
        texture=Gabor(segments=5),
        workspace=Workspace(width_m=0.08),
        render=Proxy(),
        device=Mock(path="circle"),
    )
    assert [step.product for step in pipeline.plan().steps][-1] == "touch"
    assert pipeline.disparity is not None and pipeline.disparity.disparity_px.shape == SHAPE
    assert pipeline.surface.extent_m == pytest.approx((0.08, 0.06))
    assert {outcome.product for outcome in pipeline.outcomes} >= {"views", "disparity", "surface"}
    run = pipeline.run(tmp_path / "mine", seconds=0.5)
    assert {path.name for path in run.files} >= {"sheet.png", "outcomes.json", "surface.npz", "recording.npz"}
    assert all(path.exists() for path in run.files)
    assert run.recording is not None and len(run.recording.rows) == 500
    assert {each.check for each in pipeline.preflight()} >= {"stiffness", "contact"}
    recording = pipeline.feel(Mock(path="circle"), seconds=0.3)
    assert recording.stopped == "" and len(recording.rows) > 100
    assert recording.about.device == "mock" and recording.about.renderer == "proxy"
    assert all(each._repr_html_().startswith("<img ") for each in (run, recording, pipeline.surface))
    assert all("<table>" in each._repr_html_() for each in (pipeline.plan(), pipeline, Recording(recording.rows[:0])))


class TestScene:
    def test_builtin_scene_is_found_by_name(self):
        assert Scene.builtin("coins").name == Scene.builtin("builtin/coins").name == "builtin/coins"
        with pytest.raises(ConfigError, match=r"no scene is named 'builtin/coin'.*did you mean"):
            Scene.builtin("coin")


class TestMethods:
    def test_method_of_a_class_or_a_name_is_its_object(self):
        left, right = pair()
        pipeline = Pipeline(Scene.pair(left, right), depth=Flat())
        assert pipeline.disparity is not None and (pipeline.disparity.disparity_px == 3).all()
        assert pipeline.config.depth is not None and pipeline.config.depth.name == "Flat"
        scene = Scene.photo(pair()[0])
        named = Pipeline(scene, depth="luminance", render={"use": "proxy", "radius_m": "1 mm"}, export=["stl"])
        made = Pipeline(scene, depth=Luminance(), render=Proxy(radius_m=0.001), export=[load_method("export", "stl")()])
        assert named.config == made.config

    def test_pipeline_of_what_no_file_holds_is_not_written(self, tmp_path: Path):
        for scene, depth in ((Scene.builtin("coins"), Flat()), (Scene.heights(np.eye(4)), None)):
            pipeline = Pipeline(scene, depth=depth, cached=False)
            with pytest.raises(ConfigError, match="Flat is not an installed plugin" if depth else "made of arrays"):
                pipeline.to_yaml(tmp_path / "mine.yaml")
            assert not (tmp_path / "mine.yaml").exists()
        run = pipeline.run(tmp_path)
        assert "made of arrays" in (tmp_path / "config.txt").read_text()
        assert tmp_path / "config.txt" in run.files
        with pytest.raises(ConfigError, match="no device"):
            pipeline.feel()

    @pytest.mark.usefixtures("unchecked_shapes")
    @pytest.mark.parametrize(
        ("block", "location"),
        [
            ({"workspace": {"width_m": -1}}, ("workspace", "width_m")),
            ({"workspace": {"width_m": 1e-300}}, ("workspace", "width_m")),
            ({"workspace": {"widht_m": 1}}, ("workspace", "widht_m")),
            ({"safety": {"ramp_s": "long"}}, ("safety", "ramp_s")),
            ({"materials": "smoothness"}, ("materials", "by")),
            ({"workspace": 0.08}, ("workspace",)),
        ],
    )
    def test_blocks_with_nonsense_are_refused(self, block: dict, location: tuple):
        with pytest.raises(ConfigError) as error:
            Pipeline(Scene.builtin("coins"), **block)
        assert error.value.complaints[0].location == location

    def test_other_keys_of_a_file_are_taken_and_unknown_ones_refused(self):
        scene = Scene.photo(pair()[0])
        for more, want in (({}, "surface"), ({"render": Proxy()}, "touch"), ({"want": "parts"}, "parts")):
            assert Pipeline(scene, **more).config.want == want
        for name in ("wants", "registry"):
            with pytest.raises(ArgumentError, match=f"{name}: is not a key of the pipeline file"):
                Pipeline(scene, **{name: "parts"})


class TestOthers:
    """A person who compares: the same pipeline with one thing changed, and what suits a picture."""

    def test_pipelines_are_compared_with_another_law_or_the_suited_one(self, tmp_path: Path):
        scene = Scene.photo(pair()[0])
        first = Pipeline(scene, depth="luminance", workspace={"width_m": 0.04}, title="one", cached=False)
        disparity = first.disparity
        other = first.with_(render="penalty", title=None)
        assert (other.config.want, other.config.title, first.config.render) == ("touch", "", None)
        assert other.config.workspace == first.config.workspace and other.disparity is disparity
        assert other.with_(render=None).config.want == "surface"
        assert first.with_(scene=Scene.heights(np.ones((2, 3)))).relief.height_m.shape == (2, 3)
        with pytest.raises(AttributeError, match=r"`pipeline.with_\(render=...\)` returns another one"):
            first.render = Penalty()  # pyright: ignore[reportAttributeAccessIssue]
        left, _ = pair()
        file = tmp_path / "left.png"
        Image.fromarray(left).save(file)
        typed = Pipeline.from_config(suited_config([file], default_registry()))
        for suited in (Pipeline.suited(file), Pipeline.suited(left), Pipeline.suited(Scene.photo(left))):
            keys = typed.config.as_data().keys() - {"scene"}
            assert all(getattr(suited.config, key) == getattr(typed.config, key) for key in keys)
            assert suited.plan().refusal == typed.plan().refusal == ""

    def test_pipeline_and_recording_are_seen_as_people_expect(self):
        pipeline = Pipeline(Scene.heights(np.eye(8)), render="penalty", cached=False)
        assert show(pipeline).get_title() == show(pipeline.surface).get_title()
        recording = pipeline.feel("mock", 0.05, in_real_time=False)
        table = recording.to_pandas()
        assert list(table.columns) == [*TICK_COLUMNS, "beacon"] and len(table) == len(recording.rows)
        assert (table["fz_n"] == recording.force_n[:, 2]).all() and (table["beacon"] == -1).all()


class TestThereAndBack:
    def test_file_of_a_pipeline_makes_an_equal_one(self, tmp_path: Path):
        left, right = pair()
        for name, picture in (("left", left), ("right", right)):
            np.save(tmp_path / f"{name}.npy", picture)
        cameras = Calibration(900.0, 0.1, 2.0)
        scene = Scene.pair(left=tmp_path / "left.npy", right=tmp_path / "right.npy", calibration=cameras)
        pipeline = Pipeline(
            scene,
            depth=Zncc(window_px=5, max_disparity_px=8),
            texture=Histogram(segments=2),
            materials={"by": {1: "ice", 2: "wood"}, "rules": [{"segment": 2, "material": "sand"}]},
            workspace={"width_m": 0.05, "smooth_m": 0.0005},
            render=Penalty(stiffness_n_per_m=500.0),
            device=Mock(path="raster"),
            safety={"ramp_s": 0.2},
        )
        pipeline.to_yaml(tmp_path / "elsewhere" / "mine.yaml")
        again = Pipeline.from_yaml(tmp_path / "elsewhere" / "mine.yaml")
        assert again.config.as_data() == pipeline.config.as_data()
        for product in ("disparity", "segments", "surface"):
            assert again.engine.key(product) == pipeline.engine.key(product)
        again.to_yaml(tmp_path / "again.yaml")
        assert (tmp_path / "again.yaml").read_text() == (tmp_path / "elsewhere" / "mine.yaml").read_text()


class TestWatching:
    def test_stages_are_watched_and_stopped(self):
        heard: list[StageEvent] = []
        Pipeline(Scene.heights(np.eye(4)), cached=False).make("surface", progress=heard.append)
        assert [(each.product, each.outcome and each.outcome.outcome) for each in heard] == [
            ("relief", "given"),
            ("segments", "skipped"),
            ("materials", "skipped"),
            ("surface", None),
            ("surface", "ran"),
        ]
        left, right = pair()
        stop, pipeline = threading.Event(), Pipeline(Scene.pair(left, right), depth=Slow(), cached=False)
        threading.Timer(0.2, stop.set).start()
        with pytest.raises(Stopped):
            pipeline.make("disparity", stop=stop)
        assert [outcome.outcome for outcome in pipeline.outcomes if outcome.product == "disparity"] == ["failed"]

    @pytest.mark.parametrize("in_real_time", [True, False])
    @pytest.mark.usefixtures("loop_in_thread")
    def test_stop_in_a_session_ends_it(self, in_real_time: bool):
        stop = threading.Event()
        pipeline = Pipeline(Scene.heights(np.ones((8, 8))), render=Penalty(), cached=False)
        found = pipeline.feel(
            Mock(path="circle"), 600, in_real_time=in_real_time, on_report=lambda _: stop.set(), stop=stop
        )
        assert found.stopped == STOPPED
        assert 0 < len(found.rows) < 600_000


@pytest.mark.usefixtures("loop_in_thread")
class TestFeeling:
    @pytest.fixture
    def pipeline(self) -> Pipeline:
        device = Mock(hand=None, path="circle", z_m=0.0015)
        return Pipeline(Scene.heights(np.arange(64.0).reshape(8, 8)), render=Penalty(), device=device, cached=False)

    def test_sessions_are_recorded_replayed_or_refused_without_an_end(self, pipeline: Pipeline, tmp_path: Path):
        found = pipeline.feel(seconds=0.25, in_real_time=False)
        assert len(found.rows) == 250 and found.peak_force_n > 0
        for real, name in ((True, "a.nc"), (False, "c.csv")):
            found = pipeline.feel(seconds=0.2, in_real_time=real, record=tmp_path / name)
            np.testing.assert_array_equal(Recording.load(tmp_path / name).rows, found.rows)
        with pytest.raises(OutputError, match=r"hand\.txt"):
            pipeline.feel(seconds=0.1, record=tmp_path / "hand.txt")
        rows: list[np.ndarray] = []
        found = pipeline.feel(seconds=0.2, keep=rows.append)
        assert found.rows.size == 0 and sum(map(len, rows)) > 50
        with pytest.raises(ConfigError, match="seconds"):
            pipeline.feel(seconds=None, in_real_time=False)
        with pytest.raises(ConfigError, match="in real time"):
            pipeline.feel(in_real_time=False, on_wait=pytest.fail)
        before = pipeline.feel(seconds=1.0, in_real_time=False)
        other = Pipeline(pipeline.scene, render=Penalty(stiffness_n_per_m=400.0), cached=False)
        after = Feeling(other).replay(before)
        assert (after.about.device, compare_replay(before, after)["ticks"]) == ("replay of mock", 1000)
        assert 0 < after.peak_force_n < before.peak_force_n


def test_product_is_drawn_as_its_panel():
    from matplotlib.figure import Figure

    left, right = pair()
    sample = Pipeline(Scene.pair(left, right), depth=Flat(), texture=Histogram(segments=2), cached=False)
    for product in ("views", "disparity", "segments", "relief", "surface"):
        axes = Figure().add_subplot()
        assert show(getattr(sample.scene if product == "views" else sample, product), axes) is axes
        assert axes.get_title(), product
    with pytest.raises(OutputError, match="no picture of its own"):
        show(Calibration(1.0, 1.0))


def test_touch_is_made_for_the_device_on_which_it_is_felt():
    """Through a mapping of a twentieth the hand's device is weak: a scene without a device comes after one on it."""
    same = {
        "depth": Luminance(),
        "render": Proxy(),
        "texture": Histogram(segments=2),
        "mapping": {"scale": 0.05},
        "cached": False,
    }
    views = (pair()[0] // 2).astype(np.uint8)
    first, second = Pipeline(Scene.photo(views), device=Mock(), **same), Pipeline(Scene.photo(views), **same)
    strong, weak = (each.touch.stiffness_n_per_m for each in (Feeling(second), Feeling(first)))
    assert 0 < weak < strong / 5
    assert Feeling(second)._turn(Feeling(first), None).touch.stiffness_n_per_m == weak
    assert Feeling(first, Mock()).touch.stiffness_n_per_m == Feeling(second, Mock()).touch.stiffness_n_per_m == weak
