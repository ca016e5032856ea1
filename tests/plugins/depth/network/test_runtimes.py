"""Sizes that networks declare, as OpenCV and onnxruntime write them."""

from pathlib import Path

import numpy as np
import pytest

from tangible_core.errors import ConfigError
from tangible_depth.network import runtimes

DESCRIBED = """
name: net
inputs: "left", // <Input> float [1 x 3 x 48 x 0]
        "right" // <Input> float [1 x 3 x h x 64]
outputs: "map" // <Input> float [1 x 1 x 48 x 64]
"""


def test_inputs_have_the_sizes_of_a_description():
    assert runtimes._declared(DESCRIBED) == {"left": (1, 3, 48, None), "right": (1, 3, None, 64)}


@pytest.mark.parametrize(
    ("declared", "name", "said"),
    [
        ({"a": (1, 3, 48, 64)}, "a", ""),
        ({"a": (1, 3, None, None)}, "a", ""),
        ({"a": (1, 3, 48, 60)}, "a", "48 x 60 pixels alone, and would be run on 48 x 64; write `size_px: [48, 60]`"),
        ({"a": (1, 3, 40, None)}, "", "40 x any pixels alone, and would be run on 48 x 64; write `size_px: [40, COL"),
        ({"a": (1, 3, 48, 64), "b": (1, 3, 40, 64)}, "", ""),
        ({"a": (1, 9)}, "a", ""),
        ({}, "", ""),
    ],
)
def test_input_of_another_size_than_the_only_one_is_refused(declared, name: str, said: str):
    given = {name: np.zeros((1, 3, 48, 64), np.float32)}
    if not said:
        runtimes._check_sizes(Path("net.onnx"), declared, given)
        return
    with pytest.raises(ConfigError) as refusal:
        runtimes._check_sizes(Path("net.onnx"), declared, given)
    assert said in str(refusal.value)
