"""Touches made of kernels: how they travel to another process, and how they are called."""

import pickle

import numpy as np
import pytest

from tangible_core import HapticSurface, load_method
from tangible_core.compiled import CompiledTouch
from tangible_core.kernels import Address

PATH = np.column_stack([np.linspace(-0.03, 0.03, 200), np.linspace(0.01, 0.02, 200), np.full(200, -0.001)])


def _touch(name: str) -> CompiledTouch:
    heights = np.random.default_rng(0).uniform(0, 0.004, (32, 48)).astype(np.float32)
    touch = load_method("render", name)().touch(HapticSurface.from_heights(heights))
    assert isinstance(touch, CompiledTouch)
    return touch


@pytest.mark.parametrize("name", ["proxy", "penalty", "tangible-mask"])
class TestTravel:
    def test_it_feels_the_same_in_another_process(self, name: str) -> None:
        touch = _touch(name)
        other = pickle.loads(pickle.dumps(touch))
        np.testing.assert_array_equal(other.path(PATH), touch.path(PATH))
        assert other.stiffness_n_per_m == touch.stiffness_n_per_m

    def test_its_arrays_need_not_be_copied(self, name: str) -> None:
        buffers: list[pickle.PickleBuffer] = []
        touch = _touch(name)
        small = pickle.dumps(touch, protocol=5, buffer_callback=buffers.append)
        assert len(small) < 1000
        other = pickle.loads(small, buffers=[bytearray(each.raw()) for each in buffers])
        np.testing.assert_array_equal(other.path(PATH), touch.path(PATH))


def test_the_memory_stays_what_the_law_writes_to() -> None:
    touch = pickle.loads(pickle.dumps(_touch("proxy")))
    touch.path(PATH)
    x, y, z = touch.memory[:3]
    assert touch.memory is touch.fixed[-1]
    assert abs(x) <= 0.04 and abs(y) <= 0.03 and 0 <= z <= 0.005
    touch.path(np.array([[0.0, 0.0, 1.0]]))
    assert np.isnan(touch.memory[2])


def test_an_address_has_its_kernels_signature() -> None:
    touch = _touch("proxy")
    assert "float64, float64, float64" in str(Address(touch.tick).signature())
