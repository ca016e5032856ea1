"""The header of a netCDF file of records, in the classic format with 64-bit offsets (CDF-2).

Written by hand, as libraries write the file only when it is closed, but a recording must be valid from its first byte.
Source: Unidata, NetCDF Classic Format Specification; OGC 10-092r3.
"""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

Attributes = Mapping[str, str | np.ndarray]
COUNT_AT = 4  # offset of the number of records in the file, bytes
MAX_RECORDS = 2**31 - 1  # greatest number of records of the format
DIMENSION, VARIABLE, ATTRIBUTE = 10, 11, 12  # tags of the lists in a header
CHAR, TYPES = 2, {">i4": 4, ">f4": 5, ">f8": 6}  # tags of the types: of text, and of numbers by their dtype


class Variable(NamedTuple):
    """A variable with one number a record, and its attributes."""

    dtype: str
    attributes: Attributes


def header(dimension: str, attributes: Attributes, variables: Mapping[str, Variable], records: int) -> bytes:
    """Return all bytes before the records; a record is one number of each variable, in this order, without padding."""
    start = b"CDF\x02" + integer(records) + _list(DIMENSION, [_text(dimension) + integer(0)]) + _attributes(attributes)
    begin = len(start) + len(_variables(variables, 0))  # offset of the first record
    return start + _variables(variables, begin)


def integer(number: int) -> bytes:
    """Return a count as it is written in the file."""
    return number.to_bytes(4, "big")


def _variables(variables: Mapping[str, Variable], begin: int) -> bytes:
    items: list[bytes] = []
    for name, (dtype, attributes) in variables.items():
        size = np.dtype(dtype).itemsize
        dimensions = integer(1) + integer(0)
        place = integer(TYPES[dtype]) + integer(size) + begin.to_bytes(8, "big")
        items.append(_text(name) + dimensions + _attributes(attributes) + place)
        begin += size
    return _list(VARIABLE, items)


def _attributes(attributes: Attributes) -> bytes:
    return _list(ATTRIBUTE, [_text(name) + _value(value) for name, value in attributes.items()])


def _value(value: str | np.ndarray) -> bytes:
    if isinstance(value, str):
        return integer(CHAR) + _text(value)
    return integer(TYPES[value.dtype.str]) + integer(value.size) + value.tobytes()


def _text(text: str) -> bytes:
    data = text.encode()
    return integer(len(data)) + data + bytes(-len(data) % 4)


def _list(tag: int, items: list[bytes]) -> bytes:
    return integer(tag if items else 0) + integer(len(items)) + b"".join(items)
