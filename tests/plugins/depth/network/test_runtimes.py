"""Sizes that networks declare, and the pictures that they get."""

from pathlib import Path

import numpy as np
import pytest

from tangible_core.errors import ConfigError
from tangible_depth.network import runtimes


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
