"""The network HED as it is published for Keras, made an ONNX file.

Source: Xie & Tu, Holistically-nested edge detection, ICCV 2015: VGG-16 with a side output after each of five blocks,
each enlarged to the picture, and a weighted sum of them.
"""

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np

from tangible_core.errors import BrokenMethod, ConfigError

BLOCKS = (2, 2, 3, 3, 3)  # convolutions of each
# Of an ONNX file: the wire format of Protocol Buffers, fields of onnx.proto of ONNX 1.17.
IR_VERSION, OPERATORS = 8, 13  # of the format and of the set of operators
FLOAT = 1  # float32
INTEGER, TEXT, INTEGERS = 2, 3, 7  # the types of attributes
# A message: numbers of fields with their values, an int, a text, bytes or a message, in the order of writing.
Fields: TypeAlias = Iterable[tuple[int, Any]]


def message(fields: Fields) -> bytes:
    """Return the bytes of a message."""
    parts: list[bytes] = []
    for number, value in fields:
        if isinstance(value, int):
            parts += [_varint(number << 3), _varint(value)]
            continue
        content = value.encode() if isinstance(value, str) else value if isinstance(value, bytes) else message(value)
        parts += [_varint(number << 3 | 2), _varint(len(content)), content]
    return b"".join(parts)


def _varint(value: int) -> bytes:
    groups: list[int] = []
    while value > 127:
        groups.append(value & 127 | 128)
        value >>= 7
    return bytes([*groups, value])


def node(
    operator: str, inputs: Sequence[str], output: str, **attributes: int | str | Sequence[int]
) -> list[tuple[int, Any]]:
    """Return a node of a graph."""
    fields: list[tuple[int, Any]] = [(1, name) for name in inputs]
    fields += [(2, output), (3, output), (4, operator)]
    for name, value in attributes.items():
        if isinstance(value, int):
            fields.append((5, [(1, name), (3, value), (20, INTEGER)]))
        elif isinstance(value, str):
            fields.append((5, [(1, name), (4, value), (20, TEXT)]))
        else:
            fields.append((5, [(1, name), *((8, number) for number in value), (20, INTEGERS)]))
    return fields


def network(
    nodes: Iterable[Fields],
    weights: Mapping[str, np.ndarray],
    inputs: Mapping[str, Sequence[int | str]],
    outputs: Mapping[str, Sequence[int | str]],
) -> bytes:
    """Return the file of a network. inputs, outputs: their sizes; a text names a dimension of any size."""
    graph: list[tuple[int, Any]] = [(1, fields) for fields in nodes]
    graph.append((2, "network"))
    for name, array in weights.items():
        sizes: list[tuple[int, Any]] = [(1, size) for size in array.shape]
        graph.append((5, [*sizes, (2, FLOAT), (8, name), (9, array.astype("<f4").tobytes())]))
    for field, declared in ((11, inputs), (12, outputs)):
        for name, shape in declared.items():
            sizes = [(1, [(1, size) if isinstance(size, int) else (2, size)]) for size in shape]
            graph.append((field, [(1, name), (2, [(1, [(1, FLOAT), (2, sizes)])])]))
    return message([(1, IR_VERSION), (7, graph), (8, [(1, ""), (2, OPERATORS)])])


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
