"""What an ONNX file declares, read before a runtime reads it, as runtimes trust the file."""
# OpenCV 5 ends the program at a negative size and at a text that is not UTF-8, and reads weights from any file named.
# The wire format is that of Protocol Buffers, https://protobuf.dev/programming-guides/encoding/; fields: ONNX 1.17.

import math
import mmap
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import TypeAlias, TypeVar

from tangible_core.errors import ConfigError, quoted

Shape: TypeAlias = tuple[int | None, ...]  # None for a dimension of any size
Value: TypeAlias = int | memoryview
Read = TypeVar("Read")
MAX_NUMBERS = 2**31  # of one weight: more than the largest file holds

GRAPH, PAIRS, WEIGHTS, INPUTS = 7, 14, 5, 11  # fields of a model (the first two) and of a graph
MESSAGES: Mapping[str, tuple[set[int], Mapping[int, str]]] = {
    "model": ({2, 3, 4, 6}, {7: "graph", 8: "import", 14: "pair", 25: "function"}),
    "import": ({1}, {}),
    "pair": ({1, 2}, {}),
    "function": ({1, 4, 5, 6, 8, 10, 13}, {7: "node", 9: "import", 11: "attribute", 12: "value", 14: "pair"}),
    "graph": (
        {2, 10},
        {1: "node", 5: "tensor", 11: "value", 12: "value", 13: "value", 14: "annotation", 15: "sparse", 16: "pair"},
    ),
    "annotation": ({1}, {2: "pair", 3: "pair"}),
    "node": ({1, 2, 3, 4, 6, 7, 8}, {5: "attribute", 9: "pair"}),
    "attribute": (
        {1, 4, 9, 13, 21},
        {5: "tensor", 6: "graph", 10: "tensor", 11: "graph", 14: "type", 15: "type", 22: "sparse", 23: "sparse"},
    ),
    "sparse": (set(), {1: "tensor", 2: "tensor"}),
    "tensor": ({8, 12}, {13: "pair", 16: "pair"}),
    "value": ({1, 3}, {2: "type", 4: "pair"}),
    "type": ({6}, {1: "array", 4: "type", 9: "type"}),
    "array": (set(), {1: "type", 2: "shape"}),
    "shape": (set(), {1: "dimension"}),
    "dimension": ({2, 3}, {}),
}
"""Fields of each message that are texts, and those that are messages, with their kinds."""
SIZES, NAME, PLACES = 1, 8, 13  # fields of a tensor: its dimensions, its name, the file with its numbers
VARINT, EIGHT_BYTES, BYTES, FOUR_BYTES = 0, 1, 2, 5


def read_inputs(model: Path) -> Mapping[str, Shape]:
    """Check a network's file; return the inputs that it declares, in order. Raises: ConfigError if damaged; OSError."""
    return _read(model, lambda whole: _inputs(model, whole))


def read_metadata(model: Path) -> Mapping[str, str]:
    """Return the texts that a network's file brings with it, by name. Raises: ConfigError if it is damaged; OSError."""
    return _read(model, _metadata)


def _metadata(whole: memoryview) -> Mapping[str, str]:
    pairs = ([*_parts(pair, 1), *_parts(pair, 2)] for pair in _parts(whole, PAIRS))
    return {_text(pair[0]): _text(pair[1]) for pair in pairs if len(pair) == 2}


def _read(model: Path, wanted: Callable[[memoryview], Read]) -> Read:
    damaged = ConfigError(f"model: {model} is not an ONNX file, or is damaged; fetch it again")
    if not model.stat().st_size:  # nothing can be mapped
        raise damaged
    with model.open("rb") as file:
        whole = memoryview(mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ))
    try:
        return wanted(whole)
    except (IndexError, ValueError, RecursionError) as error:
        raise damaged from error


def _inputs(model: Path, whole: memoryview) -> Mapping[str, Shape]:
    for kind, message in _messages("model", whole):
        if kind == "tensor":
            _check_tensor(model, message)
    graphs = list(_parts(whole, GRAPH))
    weights = {_name(tensor) for graph in graphs for tensor in _parts(graph, WEIGHTS)}
    inputs = dict(_input(value) for graph in graphs for value in _parts(graph, INPUTS))
    return {name: shape for name, shape in inputs.items() if name not in weights}


def _messages(kind: str, message: memoryview) -> Iterator[tuple[str, memoryview]]:
    yield kind, message
    texts, kinds = MESSAGES[kind]
    for number, value in _fields(message):
        if number in texts and isinstance(value, memoryview):
            _text(value)
        elif number in kinds and isinstance(value, memoryview):
            yield from _messages(kinds[number], value)


def _name(tensor: memoryview) -> str:
    return next((_text(name) for name in _parts(tensor, NAME)), "")


def _check_tensor(model: Path, tensor: memoryview) -> None:
    sizes = [size for number, value in _fields(tensor) if number == SIZES for size in _numbers(value)]
    if min(sizes, default=0) < 0 or math.prod(sizes) > MAX_NUMBERS:
        raise ConfigError(f"model: {model}: the weight {quoted(_name(tensor))} has the impossible size {quoted(sizes)}")
    for entry in _parts(tensor, PLACES):
        key, value = ("".join(map(_text, _parts(entry, number))) for number in (1, 2))
        if key == "location" and not (model.parent / value).resolve().is_relative_to(model.parent.resolve()):
            raise ConfigError(
                f"model: {model} takes weights from {quoted(value)}, which is outside its folder; use a network whose "
                "files lie together"
            )


def _input(value: memoryview) -> tuple[str, Shape]:
    name = next((_text(item) for item in _parts(value, 1)), "")
    shapes = [shape for kind in _parts(value, 2) for tensor in _parts(kind, 1) for shape in _parts(tensor, 2)]
    return name, tuple(_size(item) for shape in shapes[:1] for item in _parts(shape, 1))


def _size(dimension: memoryview) -> int | None:
    size = next((value for number, value in _fields(dimension) if number == 1), None)
    return size if isinstance(size, int) and size > 0 else None


def _parts(message: memoryview, number: int) -> Iterator[memoryview]:
    return (value for field, value in _fields(message) if field == number and isinstance(value, memoryview))


def _fields(message: memoryview) -> Iterator[tuple[int, Value]]:
    """Yield number and value of each field: an integer, or its bytes. Raises: IndexError, ValueError if damaged."""
    at = 0
    while at < len(message):
        key, at = _varint(message, at)
        kind, length = key & 7, {EIGHT_BYTES: 8, FOUR_BYTES: 4}.get(key & 7, 0)
        if kind == VARINT:
            value, at = _varint(message, at)
            yield key >> 3, value
            continue
        if kind == BYTES:
            length, at = _varint(message, at)
        elif not length:
            raise ValueError(f"wire type {kind}")
        if not 0 <= length <= len(message) - at:
            raise IndexError("a field ends behind the file")
        yield key >> 3, message[at : at + length]
        at += length


def _numbers(value: Value) -> Iterator[int]:
    """Yield the integers of a repeated field, packed or one by one."""
    if isinstance(value, int):
        yield value
        return
    at = 0
    while at < len(value):
        number, at = _varint(value, at)
        yield number


def _varint(message: memoryview, at: int) -> tuple[int, int]:
    value, shift = 0, 0
    while True:
        byte = message[at]
        at += 1
        value |= (byte & 0x7F) << shift
        shift += 7
        if byte < 0x80:
            break
        if shift > 63:
            raise ValueError("a number of more than ten bytes")
    value &= 2**64 - 1
    return value - (value >> 63 << 64), at


def _text(value: memoryview) -> str:
    return bytes(value).decode()
