"""Touches made of kernels: a loop in another process must feel the surface that was made here."""

import pickle
import subprocess
import sys

import numpy as np
import pytest

from tangible_core import HapticSurface, load_method
from tangible_core.compiled.touch import CompiledTouch
from tangible_core.materials.assignment import library

PATH = np.column_stack([np.linspace(-0.03, 0.03, 200), np.linspace(0.01, 0.02, 200), np.full(200, -0.001)])


def _touch(name: str) -> CompiledTouch:
    heights = np.random.default_rng(0).uniform(0, 0.004, (32, 48)).astype(np.float32)
    labels, stone = np.zeros((32, 48), np.int32), library()["stone"]
    touch = load_method("render", name)().touch(HapticSurface.from_heights(heights, 0.08, labels, (stone,)))
    assert isinstance(touch, CompiledTouch)
    return touch


@pytest.mark.parametrize("name", ["proxy", "with-materials"])
class TestPickling:
    def test_pickled_touch_gives_the_same_forces_with_arrays_out_of_band(self, name: str) -> None:
        touch = _touch(name)
        other = pickle.loads(pickle.dumps(touch))
        np.testing.assert_array_equal(other.path(PATH), touch.path(PATH))
        assert other.stiffness_n_per_m == touch.stiffness_n_per_m
        buffers: list[pickle.PickleBuffer] = []
        touch = _touch(name)
        small = pickle.dumps(touch, protocol=5, buffer_callback=buffers.append)
        assert len(small) < 3000
        other = pickle.loads(small, buffers=[bytearray(buffer.raw()) for buffer in buffers])
        np.testing.assert_array_equal(other.path(PATH), touch.path(PATH))


def test_pickled_touch_memory_is_still_a_fixed_argument() -> None:
    touch = pickle.loads(pickle.dumps(_touch("proxy")))
    touch.path(PATH)
    x, y, z = touch.memory[:3]
    assert any(touch.memory is each for each in touch.fixed)
    assert abs(x) <= 0.04 and abs(y) <= 0.03 and 0 <= z <= 0.005
    touch.path(np.array([[0.0, 0.0, 1.0]]))
    assert np.isnan(touch.memory[2])


LAW_AROUND_A_LAW = """
from tangible_core import HapticSurface, load_method
from tangible_core.compiled import kernels
import numpy as np
touch = load_method("render", "with-materials")(law="penalty", material="sand").touch(
    HapticSurface.from_heights(np.full((8, 8), 0.01)))
felt = touch.path(np.full((2, 3), 0.001))
print(felt.any(), *(len(kernel.stats.cache_misses) for kernel in (touch.tick, kernels.along)))
"""


@pytest.mark.whole
def test_kernel_compiled_for_a_nested_law_is_loaded_by_another_process() -> None:
    outputs = [
        subprocess.run([sys.executable, "-c", LAW_AROUND_A_LAW], capture_output=True, text=True, check=True).stdout
        for _ in range(2)
    ]
    assert outputs[1].split() == ["True", "0", "0"]


def test_address_differs_for_kernels_of_one_definition() -> None:
    laws = [
        load_method("render", "with-materials")(law=law, material="ice").touch(
            HapticSurface.from_heights(np.ones((8, 8)))
        )
        for law in ("penalty", "penalty-gradient")
    ]
    one, other = [law.address() for law in laws if isinstance(law, CompiledTouch)]
    assert laws[0].tick is laws[1].tick
    assert one.address != other.address and one.signature != other.signature
    assert pickle.loads(pickle.dumps(one)).address == one.address
