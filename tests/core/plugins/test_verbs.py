"""Arguments of methods and touches in plain Python: else they are asked at wrong places, or fail far away."""

import math

import numpy as np
import pytest

from tangible_core import HapticSurface, Recording, load_method
from tangible_core.data import Force, HapticState
from tangible_core.errors import ArgumentError, ConfigError, GeometryError
from tangible_core.pipeline.feeling import Feeling
from tangible_core.pipeline.pipeline import Pipeline
from tangible_core.plugins.interfaces import PlainTouch
from tangible_core.scene.scene import Scene

pytestmark = pytest.mark.usefixtures("unchecked_shapes")

SURFACE = HapticSurface.from_heights(np.zeros((4, 4)))


def test_touch_and_link_take_three_numbers():
    touch = load_method("render", "penalty")().touch(SURFACE)
    below = (0, 0, -0.001)
    assert touch.force(below) == touch.force(np.array(below)) == touch.force(HapticState(below)) != (0, 0, 0)
    with pytest.raises(ArgumentError, match="state: is None; it must be a HapticState, or three numbers"):
        touch.force(None)
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


class Tape(PlainTouch):
    """A touch that records its states, and pushes with the number of calls."""

    def __init__(self) -> None:
        self.states: list[HapticState] = []

    def force(self, state: HapticState) -> Force:
        self.states.append(state)
        return Force(1.0, 2.0, float(len(self.states)))


def test_path_calls_force_for_each_position_in_order():
    tape = Tape()
    forces = tape.path(np.array([[0, 0, 0], [0.001, 0, 0], [0.001, 0.004, -0.002]]), 0.002)
    assert forces.tolist() == [[1, 2, 1], [1, 2, 2], [1, 2, 3]]
    assert [state.position_m for state in tape.states] == [(0, 0, 0), (0.001, 0, 0), (0.001, 0.004, -0.002)]
    assert [state.velocity_m_per_s for state in tape.states] == [(0, 0, 0), (0.5, 0, 0), (0, 2, -1)]
    assert [state.time_s for state in tape.states] == [0, 0.002, 0.004]


@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf, 1.7e308])
def test_path_velocity_not_finite_is_zero(bad: float):
    tape = Tape()
    tape.path(np.array([[-bad, 0.0, 0.0], [bad, 0.0, 0.0], [0.0, 0.0, 0.0], [0.001, 0.0, 0.0]]))
    assert [state.velocity_m_per_s for state in tape.states] == [(0, 0, 0)] * 3 + [(1.0, 0, 0)]


def test_path_has_forces_by_positions_and_velocities():
    assert Tape().path(np.empty((0, 3))).shape == (0, 3)
    from tangible_core.compiled.kernels import step_velocity

    tape, path = Tape(), np.random.default_rng(0).uniform(-0.05, 0.05, (200, 3))
    path[50] = math.nan
    tape.path(path, 0.0007)
    assert [state.velocity_m_per_s for state in tape.states] == [step_velocity(path, 0.0007, i) for i in range(200)]


@pytest.mark.usefixtures("unchecked_shapes")
@pytest.mark.parametrize(
    ("positions", "period_s", "complaint"),
    [
        (np.zeros((4, 2)), 0.001, "a path is"),
        (np.zeros(3), 0.001, "a path is"),
        (np.zeros((4, 3)), 0.0, "period_s: is 0.0; it must be positive and finite"),
        (np.zeros((4, 3)), math.nan, "period_s: is nan; it must"),
        (np.zeros((4, 3)), math.inf, "period_s: is inf; it must"),
    ],
)
def test_path_of_a_wrong_shape_or_period_is_refused(positions: np.ndarray, period_s: float, complaint: str):
    with pytest.raises(GeometryError, match=complaint):
        Tape().path(positions, period_s)
