"""The network HED as it is published for Keras, made an ONNX file.

Source: Xie & Tu, Holistically-nested edge detection, ICCV 2015: VGG-16 with a side output after each of five blocks,
each enlarged to the picture, and a weighted sum of them.
"""

from pathlib import Path
from typing import Any

import numpy as np

from tangible_core.errors import BrokenMethod, ConfigError

from .onnx_writing import Fields, network, node

BLOCKS = (2, 2, 3, 3, 3)  # convolutions of each


def hed_to_onnx(weights: Path) -> bytes:
    """Return the ONNX file for these weights of Keras (HDF5). Raises: BrokenMethod without h5py, ConfigError."""
    try:
        import h5py  # pyright: ignore[reportMissingTypeStubs]
    except ImportError as error:
        raise BrokenMethod(
            "borders: the network comes in a file that h5py reads, which is not installed; "
            "pip install 'tangible-images[networks]', and add it again"
        ) from error
    arrays: dict[str, np.ndarray] = {}
    try:
        with h5py.File(weights) as file:
            nodes = _nodes(file, arrays)
    except (OSError, KeyError) as error:
        raise ConfigError(f"{weights.name}: these are not the weights of HED for Keras: {error}") from error
    return network(nodes, arrays, {"picture": [1, 3, "h", "w"]}, {"borders": [1, 1, "h", "w"]})


def _nodes(file: Any, arrays: dict[str, np.ndarray]) -> list[Fields]:
    nodes: list[Fields] = []

    def convolve(place: str, source: str, output: str, **options: Any) -> str:
        kernel, bias = (np.asarray(file[f"{place}/vars/{number}"], np.float32) for number in (0, 1))
        arrays[f"{output}.weight"], arrays[f"{output}.bias"] = kernel.transpose(3, 2, 0, 1), bias
        size = list(kernel.shape[:2])
        nodes.append(node("Conv", [source, f"{output}.weight", f"{output}.bias"], output, kernel_shape=size, **options))
        return output

    current, sides = "picture", list[str]()
    for block, count in enumerate(BLOCKS, 1):
        if block > 1:
            pool = f"pool{block}"
            nodes.append(node("MaxPool", [current], pool, kernel_shape=[2, 2], strides=[2, 2], auto_pad="SAME_UPPER"))
            current = pool
        for layer in range(count):
            place = f"block{block}/layers/conv2d" + (f"_{layer}" if layer else "")
            output = convolve(place, current, f"conv{block}_{layer}", pads=[1, 1, 1, 1])
            current = f"relu{block}_{layer}"
            nodes.append(node("Relu", [output], current))
        sides.append(convolve(f"dsn{block}", current, f"side{block}"))
    nodes.append(node("Shape", sides[:1], "size"))
    for number, side in enumerate(sides[1:], 1):
        nodes.append(
            node("Resize", [side, "", "", "size"], f"{side}.large", mode="linear",
                 coordinate_transformation_mode="half_pixel")
        )  # fmt: skip
        sides[number] = f"{side}.large"
    nodes.append(node("Concat", sides, "sides", axis=1))
    nodes.append(node("Sigmoid", [convolve("fuse", "sides", "sum")], "borders"))
    return nodes
