"""A large TIFF as bands of strips or tiles. Source: TIFF 6.0, sections 2, 3 (strips) and 15 (tiles); BigTIFF."""

import struct
from collections.abc import Iterator, Sequence
from typing import NamedTuple

from ....files.reading import MOST_PIXELS, check_bytes
from ..tiff_tags import TAG_TYPES, Tag, byte_order, tag_values, tiff_tags
from .bands import BAND_PIXELS, Bands, WholePieceError

_COLUMNS, _ROWS, _BITS, _COMPRESSION, _SAMPLES, _PLANAR, _ORIENTATION = 256, 257, 258, 259, 277, 284, 274
_STRIPS, _STRIP_ROWS, _STRIP_BYTES = 273, 278, 279
_TILE_COLUMNS, _TILE_ROWS, _TILES, _TILE_BYTES = 322, 323, 324, 325
_KEPT = (
    _COLUMNS,
    _BITS,
    _COMPRESSION,
    262,
    266,
    _SAMPLES,
    _PLANAR,
    317,
    320,
    _TILE_COLUMNS,
    _TILE_ROWS,
    338,
    339,
    347,
    530,
    532,
)
"""Tags that a band has of the whole picture: what tells how its pixels are stored."""
_BYTES = {1: 1, 2: 1, 3: 2, 4: 4, 5: 8, 7: 1, 8: 2, 9: 4, 10: 8, 11: 4, 12: 8}
"""Bytes of a value, by the type of a tag."""
_LONG = 4
_UNCOMPRESSED, _OLD_JPEG = 1, 6


class _Piece(NamedTuple):
    """The bytes of a strip or of a tile in the file."""

    at: int
    length: int


class _Layout(NamedTuple):
    """How a picture is stored: planes of rows of pieces, a piece as high as `height` rows of pixels."""

    rows: int
    columns: int
    height: int
    across: int
    planes: int
    pieces: Sequence[_Piece]
    tiled: bool


def tiff_bands(data: bytes) -> Bands:
    """Cut the first picture of a TIFF into bands.

    Raises: WholePieceError if it is one compressed strip; ValueError, KeyError or struct.error if damaged.
    """
    tags = {tag.number: tag for tag in tiff_tags(data)}
    layout = _layout(data, tags)
    return Bands(layout.rows, layout.columns, _number(data, tags, _ORIENTATION, 1), _bands(data, tags, layout))


def _layout(data: bytes, tags: dict[int, Tag]) -> _Layout:
    rows, columns = _number(data, tags, _ROWS), _number(data, tags, _COLUMNS)
    planes = _number(data, tags, _SAMPLES, 1) if _number(data, tags, _PLANAR, 1) == 2 else 1
    tiled = _TILES in tags
    height = _number(data, tags, _TILE_ROWS) if tiled else min(rows, _number(data, tags, _STRIP_ROWS, rows))
    across = -(-columns // _number(data, tags, _TILE_COLUMNS)) if tiled else 1
    places = _numbers(data, tags[_TILES if tiled else _STRIPS])
    lengths = _numbers(data, tags[_TILE_BYTES if tiled else _STRIP_BYTES])
    layout = _Layout(rows, columns, height, across, planes, list(map(_Piece, places, lengths)), tiled)
    if height * columns <= BAND_PIXELS:
        return layout
    compression = _number(data, tags, _COMPRESSION, _UNCOMPRESSED)
    if compression == _UNCOMPRESSED and not tiled and height == rows:
        bits = _number(data, tags, _BITS, 1) * (_number(data, tags, _SAMPLES, 1) if planes == 1 else 1)
        return _split(layout, -(-columns * bits // 8))
    if height * columns > MOST_PIXELS or compression == _OLD_JPEG:
        raise WholePieceError("save it in strips or in tiles, or as PNG")
    return layout


def _split(layout: _Layout, line: int) -> _Layout:
    """Divide the one uncompressed strip of each plane, `line` bytes a row, into strips of a band's height."""
    height = max(1, BAND_PIXELS // layout.columns)
    tops = range(0, layout.rows, height)
    pieces = [
        _Piece(whole.at + top * line, min(height, layout.rows - top) * line) for whole in layout.pieces for top in tops
    ]
    return layout._replace(height=height, pieces=pieces)


def _bands(data: bytes, tags: dict[int, Tag], layout: _Layout) -> Iterator[bytes]:
    down = -(-layout.rows // layout.height)
    if down * layout.across * layout.planes != len(layout.pieces):
        raise ValueError(f"it has {len(layout.pieces)} strips or tiles, which is not what its size needs")
    together = max(1, BAND_PIXELS // (layout.columns * layout.height))
    for first in range(0, down, together):
        last = min(first + together, down)
        pieces = [
            piece
            for plane in range(layout.planes)
            for piece in layout.pieces[(plane * down + first) * layout.across : (plane * down + last) * layout.across]
        ]
        check_bytes(sum(piece.length for piece in pieces))
        rows = min(last * layout.height, layout.rows) - first * layout.height
        yield _file(data, tags, layout, rows, [data[piece.at : piece.at + piece.length] for piece in pieces])


def _file(data: bytes, tags: dict[int, Tag], layout: _Layout, rows: int, pieces: list[bytes]) -> bytes:
    """Return a TIFF of these rows: its pieces, the values of its tags, and its directory."""
    order, _ = byte_order(data)
    content = bytearray((b"II*\0" if order == "<" else b"MM\0*") + bytes(4))
    starts = [_append(content, piece) for piece in pieces]
    values = {number: _copy(data, tags[number]) for number in _KEPT if number in tags}
    values[_ROWS] = _longs(order, [rows])
    values[_TILES if layout.tiled else _STRIPS] = _longs(order, starts)
    values[_TILE_BYTES if layout.tiled else _STRIP_BYTES] = _longs(order, list(map(len, pieces)))
    if not layout.tiled:
        values[_STRIP_ROWS] = _longs(order, [layout.height])
    table = struct.pack(order + "H", len(values))
    for number, (kind, count, value) in sorted(values.items()):
        stored = value.ljust(4, b"\0") if len(value) <= 4 else struct.pack(order + "I", _append(content, value))
        table += struct.pack(order + "HHI", number, kind, count) + stored
    struct.pack_into(order + "I", content, 4, _append(content, table + bytes(4)))
    return bytes(content)


def _append(content: bytearray, value: bytes) -> int:
    """Append a value at an even place, and return the place."""
    content += bytes(len(content) % 2)
    at = len(content)
    content += value
    return at


def _copy(data: bytes, tag: Tag) -> tuple[int, int, bytes]:
    return tag.kind, tag.length, tag_values(data, tag, f"{tag.length * _BYTES[tag.kind]}s")[0]


def _longs(order: str, numbers: list[int]) -> tuple[int, int, bytes]:
    return _LONG, len(numbers), struct.pack(f"{order}{len(numbers)}I", *numbers)


def _number(data: bytes, tags: dict[int, Tag], number: int, default: int | None = None) -> int:
    """Return the first value of a tag. Raises: KeyError without it and without a default; ValueError if it is 0."""
    if number not in tags and default is not None:
        return default
    value = _numbers(data, tags[number])[0]
    if value < 1:
        raise ValueError(f"its tag {number} is 0")
    return value


def _numbers(data: bytes, tag: Tag) -> tuple[int, ...]:
    return tag_values(data, tag, f"{tag.length}{TAG_TYPES[tag.kind]}")
