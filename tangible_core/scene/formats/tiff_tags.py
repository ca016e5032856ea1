"""Tags of a TIFF that are needed before its pixels: their size, the value for no data, and the description.

Every read is bounded, so that a hostile file costs neither time nor memory.
"""

import struct
from collections.abc import Iterator
from contextlib import suppress
from mmap import mmap
from typing import Any, NamedTuple

TIFF = (b"II*\0", b"MM\0*", b"MM*\0", b"II\0*", b"MM\0+", b"II+\0")
"""First bytes of a TIFF for Pillow; OpenCV knows the first two."""
TAG_TYPES = {1: "B", 3: "H", 4: "I", 16: "Q"}
"""Types of a TIFF's whole numbers, as `struct` names them."""
GDAL_NODATA, LONGEST_NUMBER = 42113, 64
DESCRIPTION, LONGEST_TEXT = 270, 250_000
MOST_TAGS, MOST_SAMPLES = 65_535, 16
"""Largest number of tags that are read, and of samples a pixel; four samples are decoded."""

Shape = tuple[int, int, int]
Buffer = bytes | mmap


class Tag(NamedTuple):
    """A tag: its number, type and count, and the position of its value, or of the value's offset."""

    number: int
    kind: int
    length: int
    at: int


def tiff_size(data: bytes) -> tuple[Shape, int]:
    """Return the shape and the bytes a value, by the first directory: the largest value of a repeated tag.

    Source: TIFF 6.0, section 2 and 15 (tiles, which are decoded whole).
    """
    sizes = {256: 1, 257: 1, 258: 1, 277: 1, 322: 1, 323: 1}
    for tag in tiff_tags(data):
        if tag.number in sizes:
            values = tag_values(data, tag, f"{min(tag.length, MOST_SAMPLES)}{TAG_TYPES[tag.kind]}")
            sizes[tag.number] = max(sizes[tag.number], *values)
    rows, columns = max(sizes[257], sizes[323]), max(sizes[256], sizes[322])
    return (rows, columns, sizes[277]), -(-sizes[258] // 8)


def tiff_tags(data: Buffer) -> Iterator[Tag]:
    """Yield the tags of the first directory. Source: TIFF 6.0, section 2; BigTIFF, whose numbers have 8 bytes."""
    order, big = byte_order(data)
    first, many, place = ("Q", "Q", "Q") if big else ("I", "H", "I")
    (at,) = struct.unpack_from(order + first, data, 8 if big else 4)
    (count,) = struct.unpack_from(order + many, data, at)
    if count > MOST_TAGS:
        raise ValueError(f"its directory has {count} tags")
    at += struct.calcsize(many)
    for _ in range(count):
        number, kind, values = struct.unpack_from(f"{order}HH{place}", data, at)
        at += struct.calcsize(f"{order}HH{place}")
        yield Tag(number, kind, values, at)
        at += struct.calcsize(place)


def tag_values(data: Buffer, tag: Tag, values: str) -> tuple[Any, ...]:
    """Unpack the value of a tag in the format `values` of `struct`; a short value stands in the directory itself."""
    order, big = byte_order(data)
    place = "Q" if big else "I"
    short = struct.calcsize(order + values) <= struct.calcsize(place)
    at = tag.at if short else struct.unpack_from(order + place, data, tag.at)[0]
    return struct.unpack_from(order + values, data, at)


def byte_order(data: Buffer) -> tuple[str, bool]:
    """Return the byte order as `struct` writes it, and True for a BigTIFF."""
    return "<" if data[:2] == b"II" else ">", b"+" in data[2:4]


def stated_nodata(data: bytes) -> float | None:
    """Return the value for no data of a GeoTIFF, if it can be read. Source: GDAL's tag 42113, a text."""
    with suppress(ValueError, struct.error):
        return float(_text(data, GDAL_NODATA, LONGEST_NUMBER))
    return None


def stated_description(data: Buffer) -> bytes:
    """Return the description in a TIFF; empty if there is none. Source: TIFF 6.0, section 8."""
    with suppress(ValueError, struct.error):
        return _text(data, DESCRIPTION, LONGEST_TEXT)
    return b""


def _text(data: Buffer, number: int, longest: int) -> bytes:
    """Return the text of a tag up to its NUL; empty without the tag. Raises: ValueError or struct.error if damaged."""
    for tag in tiff_tags(data):
        if tag.number == number:
            (text,) = tag_values(data, tag, f"{min(tag.length, longest)}s")
            return text.split(b"\0")[0]
    return b""
