"""What a TIFF states before its pixels: their size, and which value means no data."""

import struct
from collections.abc import Iterator
from contextlib import suppress
from mmap import mmap
from typing import Any, NamedTuple

TIFF = (b"II*\0", b"MM\0*", b"MM*\0", b"II\0*", b"MM\0+", b"II+\0")
"""How one begins for Pillow; OpenCV knows the first two."""
TAG_TYPES = {1: "B", 3: "H", 4: "I", 16: "Q"}
"""Of a TIFF's whole numbers, as `struct` calls them."""
GDAL_NODATA, LONGEST_NUMBER = 42113, 64
DESCRIPTION, LONGEST_TEXT = 270, 250_000
MOST_TAGS, MOST_SAMPLES = 65_535, 16
"""Of a TIFF and of a pixel in one that are looked at; four samples are read."""

Shape = tuple[int, int, int]
Buffer = bytes | mmap


class _Tag(NamedTuple):
    """One of a TIFF: its number, type and count, and where its value stands, or where it says that this stands."""

    number: int
    kind: int
    length: int
    at: int


def tiff_size(data: bytes) -> tuple[Shape, int]:
    """Shape and bytes a value, by the tags of the first directory: the largest, where a tag is there twice.

    Source: TIFF 6.0, section 2 and 15 (tiles, which are decoded whole).
    """
    said = {256: 1, 257: 1, 258: 1, 277: 1, 322: 1, 323: 1}
    for tag in _tiff_tags(data):
        if tag.number in said:
            found = _tag_values(data, tag, f"{min(tag.length, MOST_SAMPLES)}{TAG_TYPES[tag.kind]}")
            said[tag.number] = max(said[tag.number], *found)
    rows, columns = max(said[257], said[323]), max(said[256], said[322])
    return (rows, columns, said[277]), -(-said[258] // 8)


def _tiff_tags(data: Buffer) -> Iterator[_Tag]:
    """Those of the first directory. Source: TIFF 6.0, section 2; BigTIFF, whose numbers have 8 bytes."""
    order, big = _order(data)
    first, many, place = ("Q", "Q", "Q") if big else ("I", "H", "I")
    (at,) = struct.unpack_from(order + first, data, 8 if big else 4)
    (count,) = struct.unpack_from(order + many, data, at)
    if count > MOST_TAGS:
        raise ValueError(f"its directory has {count} tags")
    at += struct.calcsize(many)
    for _ in range(count):
        number, kind, values = struct.unpack_from(f"{order}HH{place}", data, at)
        at += struct.calcsize(f"{order}HH{place}")
        yield _Tag(number, kind, values, at)
        at += struct.calcsize(place)


def _tag_values(data: Buffer, tag: _Tag, values: str) -> tuple[Any, ...]:
    """What `struct` reads at a tag; short values stand in the directory itself."""
    order, big = _order(data)
    place = "Q" if big else "I"
    short = struct.calcsize(order + values) <= struct.calcsize(place)
    return struct.unpack_from(
        order + values, data, tag.at if short else struct.unpack_from(order + place, data, tag.at)[0]
    )


def _order(data: Buffer) -> tuple[str, bool]:
    return "<" if data[:2] == b"II" else ">", b"+" in data[2:4]


def stated_nodata(data: bytes) -> float | None:
    """The number that stands for no data in a GeoTIFF, where it can be read. Source: GDAL's tag 42113, a text."""
    with suppress(ValueError, struct.error):
        for tag in _tiff_tags(data):
            if tag.number == GDAL_NODATA:
                (text,) = _tag_values(data, tag, f"{min(tag.length, LONGEST_NUMBER)}s")
                return float(text.split(b"\0")[0])
    return None


def stated_description(data: Buffer) -> bytes:
    """The text of a TIFF on what it shows, without its end; empty where there is none. Source: TIFF 6.0, section 8."""
    with suppress(ValueError, struct.error):
        for tag in _tiff_tags(data):
            if tag.number == DESCRIPTION:
                (text,) = _tag_values(data, tag, f"{min(tag.length, LONGEST_TEXT)}s")
                return text.split(b"\0")[0]
    return b""
