"""Writing of a network as an ONNX file: the wire format of Protocol Buffers, fields of onnx.proto of ONNX 1.17."""

from collections.abc import Iterable, Mapping, Sequence
from typing import Any, TypeAlias

import numpy as np

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
