"""The arguments and results of every method's verb: three numbers do for a state, and only views for views."""

import numpy as np
import pytest

from tangible_core import DisparityMap, HapticState, HapticSurface, Recording, Views, load_method
from tangible_core.data import Force
from tangible_core.errors import ArgumentError, BrokenMethod, ConfigError
from tangible_core.pipeline.feeling import Feeling
from tangible_core.pipeline.pipeline import Pipeline
from tangible_core.plugins import DepthEstimator
from tangible_core.plugins.interfaces import KINDS
from tangible_core.scene.scene import Scene

pytestmark = pytest.mark.usefixtures("unchecked_shapes")

SURFACE = HapticSurface.from_heights(np.zeros((4, 4)))


def test_touch_takes_three_numbers_for_a_state():
    touch = load_method("render", "penalty")().touch(SURFACE)
    below = (0, 0, -0.001)
    assert touch.force(below) == touch.force(np.array(below)) == touch.force(HapticState(below)) != (0, 0, 0)
    with pytest.raises(ArgumentError, match="state: is None; it must be a HapticState, or three numbers"):
        touch.force(None)


def test_link_takes_three_numbers_for_a_force():
    with load_method("device", "mock")().open() as link:
        link.write((0, 0, 1))
        assert link.applied == Force(0.0, 0.0, 1.0)
        with pytest.raises(ArgumentError, match="force: is None; it must be a Force, or three numbers"):
            link.write(None)


@pytest.mark.parametrize(
    ("kind", "name", "verb", "complaint"),
    [
        ("depth", "semi-global", "estimate", "views: is the str 'x'; it must be a Views, such as Views"),
        ("texture", "gradient", "segment", "picture: is the str 'x'; it must be an array of numbers"),
        ("render", "proxy", "touch", "surface: is the str 'x'; it must be a HapticSurface, such as from_heights makes"),
    ],
)
def test_method_with_a_wrong_argument_is_refused(kind, name, verb, complaint):
    with pytest.raises(ArgumentError, match=complaint):
        getattr(load_method(kind, name)(), verb)("x")


def test_segmenter_takes_a_picture_of_lists():
    assert load_method("texture", "gradient")().segment([[0.0, 1.0], [1.0, 0.0]]).labels.shape == (2, 2)


def test_wrong_result_without_a_distribution_names_the_class():
    class Odd(DepthEstimator):
        def estimate(self, views: Views) -> DisparityMap:
            return views  # pyright: ignore[reportReturnType]

    with pytest.raises(BrokenMethod, match=r"test_verbs\..*Odd: estimate gave a Views; it must give a DisparityMap"):
        Odd().estimate(Views(np.zeros((2, 2), np.uint8)))


def test_wrapped_verb_keeps_its_name():
    for kind, name in (("depth", "zncc"), ("texture", "gradient"), ("render", "proxy"), ("device", "mock")):
        cls = load_method(kind, name)
        for verb in KINDS[kind].__abstractmethods__:
            assert getattr(cls, verb).__qualname__ == f"{cls.__name__}.{verb}"
            assert not cls.__abstractmethods__


class TestPipelines:
    def test_pipeline_with_wrong_arguments_is_refused(self, tmp_path):
        with pytest.raises(ArgumentError, match=r"scene: is the str .x\.png.; it must be a Scene, such as"):
            Pipeline("x.png")
        law, device = load_method("render", "penalty")(), load_method("device", "mock")()
        pipeline = Pipeline(Scene.heights(np.eye(4)), render=law, device=device, cached=False)
        for feel in (pipeline.feel, pipeline.preflight):
            with pytest.raises(ConfigError, match="device: takes an object, not the name 'mock'; `load_method"):
                feel("mock")
        with pytest.raises(ArgumentError, match="seconds: is the str '1'; it must be a number"):
            pipeline.feel(seconds="1", in_real_time=False)
        path = str(tmp_path / "hand.nc")
        recording = pipeline.feel(seconds=0.01, in_real_time=False, record=path)
        assert Recording.load(path).digest() == recording.digest()
        assert Feeling(pipeline).replay(path).rows.shape == recording.rows.shape
