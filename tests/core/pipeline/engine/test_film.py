"""Films. Otherwise a video would be felt at a wrong time or height, or a session with one would not end."""

import threading
import time

import cv2
import numpy as np
import pytest

from films import layered, true_disparity
from tangible_core import Pipeline, Scene
from tangible_core.data import DisparityMap, Views
from tangible_core.errors import BrokenMethod, ConfigError
from tangible_core.pipeline.engine.film import PipelineFrames
from tangible_core.pipeline.engine.stage import Context
from tangible_core.pipeline.engine.stages.relief import ReliefStage
from tangible_core.pipeline.feeling import Feeling
from tangible_core.plugins.interfaces import DepthEstimator
from tangible_core.scene import pair_checks
from tangible_depth import Luminance, SemiGlobal
from tangible_devices import Mock
from tangible_render import Penalty, Proxy
from tangible_texture import Histogram

COUNT = 8


@pytest.fixture(scope="module")
def walk(tmp_path_factory):
    """Write a folder of pairs side by side, in which a box walks over a ground."""
    folder, generator = tmp_path_factory.mktemp("walk"), np.random.default_rng(8)
    for number in range(COUNT):
        views = layered(number, 1.0, generator)
        cv2.imwrite(str(folder / f"{number:03}.png"), np.hstack([views.left, views.right]))
    return folder


@pytest.fixture
def film_pipeline(walk):
    """Return a function that makes a pipeline of the video."""

    def make(**changed):
        scene = Scene.video(walk, layout="side-by-side", fps=20, repeat=False)
        methods = {"depth": SemiGlobal(resolution="half", max_disparity_px=32), "render": Proxy()}
        return Pipeline(scene, **methods | changed, cached=False)

    return make


def test_frames_equal_the_stills_of_their_disparity_and_scale(film_pipeline, walk):
    one_camera = Pipeline(Scene.video(walk, fps=20, repeat=False), depth=Luminance(), cached=False)
    for pipeline in (film_pipeline(), one_camera):
        with Feeling(pipeline).reliefs as reliefs:
            first = next(iter(reliefs))
        assert np.ptp(first.relief.height_m) > 0.0005
        assert np.array_equal(first.relief.height_m, pipeline.relief.height_m)
    pipeline = film_pipeline()
    later = Pipeline(Scene.pair(walk / "004.png", layout="side-by-side"), depth=pipeline.config.depth.method)
    maker = PipelineFrames(pipeline.config, pipeline.scene)
    scale = maker.scale(pipeline.disparity)
    first = maker.begin(pipeline.scene.views)
    assert np.array_equal(first.disparity_px, maker.disparity(pipeline.scene.views).disparity_px)
    disparity = maker.disparity(later.scene.views)
    assert np.array_equal(disparity.disparity_px, later.disparity.disparity_px)
    still = ReliefStage(Context(pipeline.config, later.scene)).from_disparity(later.disparity, scale)
    assert np.array_equal(maker.relief(disparity, scale).height_m, still.height_m)


def test_box_of_the_video_walks_in_the_reliefs(film_pipeline):
    pipeline = film_pipeline(workspace={"smooth_m": 0}, relief={"slope": 0})
    with Feeling(pipeline).reliefs as reliefs:
        film = [relief.relief.height_m for relief in reliefs]
    assert len(film) == COUNT
    for number in (0, COUNT - 1):
        box = true_disparity(max(0, number - 1)) == 16
        assert (film[number] > 0.004)[box].mean() > 0.85
        assert (film[number] > 0.004)[~box].mean() < 0.1


def test_exchanged_views_stay_exchanged_in_later_frames(walk, tmp_path, monkeypatch):
    monkeypatch.setattr(pair_checks, "view_order", lambda *_: pair_checks.ViewOrder(True, "exchanged"))
    for path in walk.iterdir():
        left, right = np.split(cv2.imread(str(path)), 2, axis=1)
        cv2.imwrite(str(tmp_path / path.name), np.hstack([right, left]))
    scene = Scene.video(tmp_path, layout="side-by-side", fps=20, repeat=False)
    pipeline = Pipeline(scene, depth=SemiGlobal(resolution="half"), workspace={"smooth_m": 0}, cached=False)
    with Feeling(pipeline).reliefs as reliefs:
        film = [relief.relief.height_m for relief in reliefs]
    assert all(each[5, 64] < 0.002 for each in film), "the ground is low"
    assert all(each.max() > 0.0045 for each in film)


def test_film_runs_by_the_clock_of_a_simulated_device(film_pipeline):
    reports = []
    pipeline = film_pipeline(texture=Histogram(segments=2), parts={1: "ground"})
    recording = pipeline.feel(Mock(path="circle"), 0.6, in_real_time=False, beacon="ground", on_report=reports.append)
    frames = recording.frame
    assert np.array_equal(np.unique(frames[np.isfinite(frames)]), np.arange(COUNT))
    assert np.all(np.diff(frames[np.isfinite(frames)]) >= 0)
    assert np.abs(recording.time_s[np.searchsorted(frames, 4)] - recording.time_s[0] - 0.2) < 0.06
    assert reports[-1].film.shown == COUNT and reports[-1].film.skipped == 0
    again = pipeline.feel(Mock(path="circle"), 0.6, in_real_time=False, beacon="ground")
    assert np.array_equal(recording.rows, again.rows, equal_nan=True)


def test_what_cannot_be_a_film_is_refused(film_pipeline, walk):
    still = Pipeline(Scene.photo(walk / "000.png"), depth=Luminance(), render=Proxy(), cached=False)
    for feel, words in (
        (lambda: film_pipeline(render=Penalty()).feel(Mock(), 0.1, in_real_time=False), "penalty.*proxy"),
        (lambda: film_pipeline(texture=Histogram(segments=2), heights="guess").feel(Mock(), 0.1), "`heights:`"),
        (lambda: Feeling(film_pipeline(relief="figure")).reliefs, "not of figure; leave `by: figure` out"),
        (lambda: Feeling(still).reliefs, "does not move"),
        (lambda: Feeling(still).film(), "does not move"),
    ):
        with pytest.raises(ConfigError, match=words):
            feel()


@pytest.mark.usefixtures("loop_in_thread")
def test_film_in_real_time_is_recorded(film_pipeline, tmp_path):
    reports, file = [], tmp_path / "hand.nc"
    recording = film_pipeline().feel(Mock(path="circle"), 1.5, on_report=reports.append, record=file)
    film = reports[-1].film
    assert film.shown + film.skipped >= 2 and film.damaged == 0
    assert film.age_ms > 0
    felt = recording.frame[np.isfinite(recording.frame)]
    assert felt.size and np.all(np.diff(felt) >= 0) and felt[-1] > 0
    assert not [each for each in threading.enumerate() if each.name == "film"]


class Shrinks(DepthEstimator):
    """Makes a smaller map of every frame but the first."""

    def estimate(self, views: Views) -> DisparityMap:
        """Make a smaller map of every frame but the first."""
        shape = views.shape if views.left.mean() == FIRST_MEAN else (3, 4)
        return DisparityMap(np.tile(np.arange(shape[1], dtype=np.float32), (shape[0], 1)))


FIRST_MEAN = 0.0


@pytest.mark.parametrize("in_real_time", [True, False])
@pytest.mark.usefixtures("loop_in_thread")
def test_film_with_a_plugin_fault_ends_the_session(film_pipeline, monkeypatch, in_real_time):
    pipeline = film_pipeline(depth=Shrinks())
    monkeypatch.setitem(globals(), "FIRST_MEAN", pipeline.scene.views.left.mean())
    began = time.monotonic()
    with pytest.raises(BrokenMethod, match="made disparity of 4 x 3"):
        pipeline.feel(Mock(path="circle"), 60.0, in_real_time=in_real_time)
    assert time.monotonic() - began < 50


@pytest.mark.usefixtures("loop_in_thread")
def test_film_is_stopped_soon_and_leaves_no_thread(film_pipeline):
    stop, began = threading.Event(), time.monotonic()

    def listen(report):
        nonlocal began
        if not stop.is_set() and report.film and report.film.shown:
            began = time.monotonic()
            stop.set()

    recording = film_pipeline().feel(Mock(path="circle"), 60.0, stop=stop, on_report=listen)
    assert recording.stopped and time.monotonic() - began < 10
    assert not [each for each in threading.enumerate() if each.name == "film"]
