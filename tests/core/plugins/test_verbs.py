"""Arguments and results of methods. Otherwise a wrong one would fail far away, without the name of its method."""

import numpy as np
import pytest

from tangible_core import HapticState, HapticSurface, Recording, load_method
from tangible_core.data import Force
from tangible_core.errors import ArgumentError, ConfigError
from tangible_core.pipeline.feeling import Feeling
from tangible_core.pipeline.pipeline import Pipeline
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
    ("kind", "name", "verb"),
    [("depth", "semi-global", "estimate"), ("texture", "gradient", "segment"), ("render", "proxy", "touch")],
)
def test_method_with_a_wrong_argument_is_refused(kind: str, name: str, verb: str):
    with pytest.raises(ArgumentError, match="is the str 'x'; it must be"):
        getattr(load_method(kind, name)(), verb)("x")
    assert load_method("texture", "gradient")().segment([[0.0, 1.0], [1.0, 0.0]]).labels.shape == (2, 2)


def test_pipeline_with_wrong_arguments_is_refused(tmp_path):
    with pytest.raises(ArgumentError, match=r"scene: is the str .x\.png.; it must be a Scene"):
        Pipeline("x.png")
    law, device = load_method("render", "penalty")(), load_method("device", "mock")()
    pipeline = Pipeline(Scene.heights(np.eye(4)), render=law, device=device, cached=False)
    for feel in (pipeline.feel, pipeline.preflight):
        with pytest.raises(ConfigError, match="device: takes a name, or an object of a class of HapticDevice, not 7"):
            feel(7)
    with pytest.raises(ArgumentError, match="seconds: is the str '1'"):
        pipeline.feel(seconds="1", in_real_time=False)
    path = str(tmp_path / "hand.nc")
    recording = pipeline.feel(seconds=0.01, in_real_time=False, record=path)
    assert Recording.load(path).digest() == recording.digest()
    assert Feeling(pipeline).replay(path).rows.shape == recording.rows.shape
