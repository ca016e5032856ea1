"""The door: all that a file can say and a command can do, said and done in Python."""

import logging
import threading
from pathlib import Path

import numpy as np
import pytest

from tangible_core import Calibration, DisparityMap, Pipeline, Recording, Scene, Views, Workspace, load_pipeline, show
from tangible_core.data import HapticSurface, Plan
from tangible_core.errors import (
    ArgumentError,
    ConfigError,
    DeviceError,
    OutputError,
    PictureError,
    Stopped,
    UnknownMethod,
)
from tangible_core.pipeline.engine.stage import StageEvent
from tangible_core.pipeline.feeling import Feeling
from tangible_core.plugins import DepthEstimator
from tangible_core.scene.scene_source import source_of_arguments
from tangible_core.session import STOPPED, compare_replay
from tangible_depth import Luminance, SemiGlobal, Zncc
from tangible_devices import Mock
from tangible_render import GreyLevel, Penalty, Proxy
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
    scene = Scene.pair(left, right, calibration=Calibration(994.978, 0.193, 31.086))
    pipeline = Pipeline(
        scene,
        depth=SemiGlobal(),
        texture=Gabor(segments=5),
        workspace=Workspace(width_m=0.08),
        render=Proxy(),
        device=Mock(path="circle"),
    )
    plan = pipeline.plan()
    assert isinstance(plan, Plan)
    assert repr(plan).splitlines()[0].split() == ["product", "method", "outcome", "why"]
    assert "<table>" in plan._repr_html_()
    assert pipeline.disparity is not None and pipeline.disparity.disparity_px.shape == SHAPE
    assert pipeline.surface.extent_m == pytest.approx((0.08, 0.06))
    assert {each.product for each in pipeline.outcomes} >= {"views", "disparity", "surface"}
    run = pipeline.run(tmp_path / "mine", seconds=0.5)
    assert {path.name for path in run.files} >= {"sheet.png", "outcomes.json", "surface.npz", "recording.npz"}
    assert all(path.exists() for path in run.files)
    assert run.recording is not None and len(run.recording.rows) == 500
    assert run._repr_html_().startswith("<img ")
    verdicts = pipeline.preflight()
    assert {each.check for each in verdicts} >= {"stiffness", "contact"}
    recording = pipeline.feel(Mock(path="circle"), seconds=0.3)
    assert recording.stopped == "" and len(recording.rows) > 100
    assert recording.about.device == "mock" and recording.about.renderer == "proxy"


class TestScene:
    def test_scene_of_files_equals_that_of_arrays(self, tmp_path: Path):
        left, right = pair()
        np.save(tmp_path / "left.npy", left)
        of_files = Scene.pair(left=tmp_path / "left.npy", right=right)
        assert of_files.views is not None
        of_arrays = Scene.pair(left, right).views
        assert of_arrays is not None
        assert of_files.views.digest() == of_arrays.digest()

    def test_scene_is_not_changed_by_later_changes_of_arrays(self):
        left, right = pair()
        scene = Scene.pair(left, right)
        before = scene.views.left.copy() if scene.views else None
        left[:] = 0
        assert scene.views is not None
        np.testing.assert_array_equal(scene.views.left, before)

    def test_scene_of_heights_has_their_relief(self):
        scene = Scene.heights([[0, 1], [2, 3]], relief_m=0.006)
        assert Pipeline(scene, cached=False).surface.height_m.max() == np.float32(0.006)

    def test_scene_of_custom_labels_and_disparity_is_made_of_them(self):
        left, right = pair()
        labels = np.repeat([[7, 9]], SHAPE[0], axis=0).repeat(SHAPE[1] // 2, axis=1)
        scene = Scene.pair(left, right, disparity=np.ones(SHAPE), segments=labels)
        pipeline = Pipeline(scene, materials={0: "ice", 1: "sand"}, cached=False)
        assert pipeline.segments is not None and pipeline.segments.count == 2
        assert pipeline.materials is not None
        assert [each.name for each in pipeline.materials.materials] == ["ice", "sand"]
        kinds = {each.product: each.outcome for each in pipeline.outcomes}
        assert (kinds["disparity"], kinds["segments"]) == ("given", "given")

    def test_builtin_scene_is_found_by_name(self):
        assert Scene.builtin("coins").name == Scene.builtin("builtin/coins").name == "builtin/coins"
        with pytest.raises(ConfigError, match=r"no scene is named 'builtin/coin'.*did you mean"):
            Scene.builtin("coin")

    @pytest.mark.parametrize(
        ("parts", "said"),
        [
            ({}, "a scene is either left and right, or photo, or height, or video; this one gives nothing"),
            ({"left": np.zeros(SHAPE)}, "this one gives left"),
            ({"photo": np.zeros(SHAPE), "relief_m": 0.01}, "relief_m needs height"),
        ],
    )
    def test_scene_of_impossible_parts_is_refused(self, parts: dict, said: str):
        with pytest.raises(ConfigError, match=said):
            source_of_arguments(parts)

    @pytest.mark.parametrize(
        ("photo", "said"),
        [
            (np.full(SHAPE, np.nan), "NaN"),
            (np.zeros((3, 3, 5)), r"the array given as photo"),
            (np.zeros((0, 3)), "the array given as photo"),
            ("nowhere.png", "there is no such file"),
        ],
    )
    def test_scene_of_an_invalid_picture_is_refused(self, photo: object, said: str):
        with pytest.raises(PictureError, match=said):
            Scene.photo(photo)  # pyright: ignore[reportArgumentType]

    def test_scene_with_nan_is_masked_on_request(self):
        photo = np.ones((4, 4), np.float32)
        photo[0, 0] = np.nan
        scene = Scene.photo(photo, non_finite="mask")
        assert scene.known is not None and not scene.known[0, 0] and scene.known.sum() == 15

    def test_scene_of_different_sizes_is_refused(self):
        with pytest.raises(PictureError, match="all parts of a scene must be of one size"):
            Scene.pair(left=np.zeros((4, 4)), right=np.zeros((4, 5)))


class TestMethods:
    def test_method_of_a_custom_class_is_used(self):
        left, right = pair()
        pipeline = Pipeline(Scene.pair(left, right), depth=Flat())
        assert pipeline.disparity is not None and (pipeline.disparity.disparity_px == 3).all()
        assert pipeline.config.depth is not None and pipeline.config.depth.name == "Flat"

    def test_method_with_other_options_is_not_answered_from_the_cache(self):
        left, right = pair()
        for value in (3.0, 4.0, 3.0):
            found = Pipeline(Scene.pair(left, right), depth=Flat(value_px=value)).disparity
            assert found is not None and (found.disparity_px == value).all()

    def test_method_of_a_custom_class_is_in_no_file(self, tmp_path: Path):
        pipeline = Pipeline(Scene.builtin("coins"), depth=Flat())
        with pytest.raises(ConfigError, match=r"depth: Flat is not an installed plugin.*tangible.depth"):
            pipeline.to_yaml(tmp_path / "mine.yaml")
        assert not (tmp_path / "mine.yaml").exists()

    def test_missing_method_is_named_with_the_cure(self):
        pipeline = Pipeline(Scene.builtin("coins"), cached=False)
        with pytest.raises(ConfigError, match=r"^the pipeline has no depth; give it one: Pipeline\(scene, depth=...\)"):
            pipeline.surface  # noqa: B018
        with pytest.raises(ConfigError, match="the pipeline has no device"):
            pipeline.feel()

    @pytest.mark.usefixtures("unchecked_shapes")
    @pytest.mark.parametrize("wrong", ["semi-global", SemiGlobal, Gabor()])
    def test_method_of_another_kind_is_refused(self, wrong: object):
        with pytest.raises(ConfigError, match=r"depth: takes an object(, not the name| of a class of DepthEst)"):
            Pipeline(Scene.builtin("coins"), depth=wrong)  # pyright: ignore[reportArgumentType]

    @pytest.mark.usefixtures("unchecked_shapes")
    @pytest.mark.parametrize(
        ("block", "said"),
        [
            ({"workspace": {"width_m": -1}}, "workspace.width_m: Input should be greater than or equal to 0.000001"),
            ({"workspace": {"width_m": 1e-300}}, "workspace.width_m: Input should be greater than or equal to"),
            ({"workspace": {"widht_m": 1}}, r"workspace.widht_m: unknown option \(did you mean 'width_m'\?\)"),
            ({"safety": {"ramp_s": "long"}}, "safety.ramp_s"),
            ({"materials": "smoothness"}, "materials.by"),
            ({"workspace": 0.08}, "workspace: Input should be a mapping, such as {key: value}, not 0.08"),
        ],
    )
    def test_blocks_with_nonsense_are_refused(self, block: dict, said: str):
        with pytest.raises(ConfigError, match=said) as error:
            Pipeline(Scene.builtin("coins"), **block)
        assert error.value.complaints[0].location == tuple(said.partition(":")[0].split("."))

    def test_other_keys_of_a_file_are_taken_and_unknown_ones_refused(self):
        scene = Scene.photo(pair()[0])
        for more, want in (({}, "surface"), ({"render": Proxy()}, "touch"), ({"want": "parts"}, "parts")):
            assert Pipeline(scene, **more).config.want == want
        for name in ("wants", "registry"):
            with pytest.raises(ArgumentError, match=f"{name}: is not a key of the pipeline file"):
                Pipeline(scene, **{name: "parts"})

    def test_unknown_product_is_refused_with_the_nearest(self):
        with pytest.raises(UnknownMethod, match="no product is named 'surfaces'"):
            Pipeline(Scene.builtin("coins")).make("surfaces")


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
            materials={"by": {0: "ice", 1: "wood"}, "rules": [{"segment": 1, "material": "sand"}]},
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

    def test_file_of_a_builtin_scene_makes_an_equal_one(self, tmp_path: Path):
        Pipeline(Scene.builtin("coins"), render=GreyLevel()).to_yaml(tmp_path / "mine.yaml")
        assert load_pipeline(tmp_path / "mine.yaml").config.scene == "builtin/coins"

    def test_file_of_a_scene_of_arrays_is_refused(self, tmp_path: Path):
        with pytest.raises(ConfigError, match="scene: is made of arrays"):
            Pipeline(Scene.heights(np.eye(4))).to_yaml(tmp_path / "mine.yaml")

    def test_run_without_a_configuration_file_writes_the_reason(self, tmp_path: Path):
        run = Pipeline(Scene.heights(np.eye(4)), cached=False).run(tmp_path)
        assert "scene: is made of arrays" in (tmp_path / "config.txt").read_text()
        assert tmp_path / "config.txt" in run.files


class TestWatching:
    def test_progress_has_the_start_and_outcome_of_each_stage(self):
        heard: list[StageEvent] = []
        Pipeline(Scene.heights(np.eye(4)), cached=False).make("surface", progress=heard.append)
        assert [(each.product, each.outcome and each.outcome.outcome) for each in heard] == [
            ("relief", "given"),
            ("segments", "skipped"),
            ("materials", "skipped"),
            ("surface", None),
            ("surface", "ran"),
        ]

    def test_stop_between_stages_raises_stopped(self):
        left, right = pair()
        stop = threading.Event()
        pipeline = Pipeline(Scene.pair(left, right), depth=Flat(), cached=False)
        with pytest.raises(Stopped, match="stopped on request"):
            pipeline.make("surface", progress=lambda stage: stop.set(), stop=stop)
        assert pipeline.surface.height_m.shape == SHAPE

    def test_stop_within_a_long_stage_raises_stopped(self):
        left, right = pair()
        stop, pipeline = threading.Event(), Pipeline(Scene.pair(left, right), depth=Slow(), cached=False)
        threading.Timer(0.2, stop.set).start()
        with pytest.raises(Stopped):
            pipeline.make("disparity", stop=stop)
        assert [each.outcome for each in pipeline.outcomes if each.product == "disparity"] == ["failed"]

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

    def test_simulated_session_is_recorded_and_reported(self, pipeline: Pipeline):
        found = pipeline.feel(seconds=0.25, in_real_time=False)
        assert len(found.rows) == 250 and found.peak_force_n > 0

    def test_session_is_recorded_into_a_file(self, pipeline: Pipeline, tmp_path: Path):
        for real, name in ((True, "a.nc"), (True, "b.npz"), (False, "c.csv")):
            found = pipeline.feel(seconds=0.2, in_real_time=real, record=tmp_path / name)
            np.testing.assert_array_equal(Recording.load(tmp_path / name).rows, found.rows)

    def test_session_passes_ticks_to_a_function(self, pipeline: Pipeline):
        rows: list[np.ndarray] = []
        found = pipeline.feel(seconds=0.2, keep=rows.append)
        assert found.rows.size == 0 and sum(map(len, rows)) > 50

    def test_session_with_an_invalid_file_is_refused(self, pipeline: Pipeline, tmp_path: Path):
        with pytest.raises(OutputError, match=r"hand\.txt"):
            pipeline.feel(seconds=0.1, record=tmp_path / "hand.txt")

    def test_simulated_session_without_end_is_refused(self, pipeline: Pipeline):
        with pytest.raises(ConfigError, match="seconds: is inf; it must be positive and finite"):
            pipeline.feel(seconds=None, in_real_time=False)
        with pytest.raises(ConfigError, match="then, on_wait: are for a session in real time"):
            pipeline.feel(in_real_time=False, on_wait=pytest.fail)

    def test_recording_is_replayed_with_another_law(self, pipeline: Pipeline):
        before = pipeline.feel(seconds=1.0, in_real_time=False)
        other = Pipeline(pipeline.scene, render=Penalty(stiffness_n_per_m=400.0), cached=False)
        after = Feeling(other).replay(before)
        assert after.about.device == "replay of mock"
        assert compare_replay(before, after)["ticks"] == 1000
        assert 0 < after.peak_force_n < before.peak_force_n

    def test_session_with_a_failing_device_keeps_its_ticks(self, pipeline: Pipeline):
        from loop_devices import Failing

        with pytest.raises(DeviceError):
            pipeline.feel(Failing(opens="never"), seconds=0.1, in_real_time=False)


@pytest.fixture(scope="module")
def sample_pipeline() -> Pipeline:
    left, right = pair()
    scene, texture = Scene.pair(left, right), Histogram(segments=2)
    return Pipeline(scene, depth=Flat(), texture=texture, render=Penalty(), cached=False)


class TestShown:
    @pytest.mark.parametrize("product", ["views", "disparity", "segments", "relief", "surface"])
    def test_product_is_drawn_as_its_panel(self, sample_pipeline: Pipeline, product: str):
        from matplotlib import pyplot
        from matplotlib.figure import Figure

        record = getattr(sample_pipeline.scene if product == "views" else sample_pipeline, product)
        axes = Figure().add_subplot()
        assert show(record, axes) is axes
        assert axes.get_title()
        alone = show(record)
        assert alone.get_title() == axes.get_title()
        pyplot.close("all")

    @pytest.mark.parametrize("product", ["views", "disparity", "segments", "relief", "surface"])
    def test_product_in_a_notebook_is_a_picture(self, sample_pipeline: Pipeline, product: str):
        from matplotlib import pyplot

        before = pyplot.get_fignums()
        html = getattr(sample_pipeline.scene if product == "views" else sample_pipeline, product)._repr_html_()
        assert html.startswith("<img alt=") and "data:image/png;base64," in html
        assert pyplot.get_fignums() == before

    def test_plan_and_outcomes_are_shown_as_tables(self, sample_pipeline: Pipeline):
        assert sample_pipeline.materials is not None
        assert "<td" in sample_pipeline.materials._repr_html_()
        assert "&lt;" not in sample_pipeline.outcomes._repr_html_()
        assert "relief" in repr(sample_pipeline.outcomes)
        assert "<table>" in sample_pipeline._repr_html_()
        assert "<table>" in Calibration(1.0, 1.0)._repr_html_()

    def test_recording_is_drawn(self, sample_pipeline: Pipeline):
        found = sample_pipeline.feel(Mock(), seconds=0.1, in_real_time=False)
        assert found._repr_html_().startswith("<img ")
        empty = Recording(found.rows[:0])
        assert "<table>" in empty._repr_html_()

    def test_record_without_a_picture_is_refused(self):
        with pytest.raises(OutputError, match="a Calibration has no picture of its own"):
            show(Calibration(1.0, 1.0))

    def test_properties_have_the_types_of_their_products(self, sample_pipeline: Pipeline):
        assert isinstance(sample_pipeline.make("surface"), HapticSurface)
        logging.getLogger(__name__).debug("%s", sample_pipeline.make("surface").extent_m)


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
