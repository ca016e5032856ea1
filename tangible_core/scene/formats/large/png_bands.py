"""A large PNG as bands of rows. Source: PNG, third edition, sections 5 (chunks), 8 (interlacing) and 9 (filters)."""

import struct
import zlib
from collections.abc import Iterator
from typing import NamedTuple, cast

import cv2
import numpy as np

from ....files.reading import check_size
from ....runtime.opencv import silent_opencv
from .bands import BAND_PIXELS, Bands, WholePieceError

SIGNATURE = b"\x89PNG\r\n\x1a\n"
_ORIENTATION = 0x0112  # tag of EXIF
_GREY, _RGB, _RGBA = 0, 2, 6
_CHANNELS = {_GREY: 1, _RGB: 3, 3: 1, 4: 2, _RGBA: 4}
"""Channels by the kind of colour."""
_STAND_IN = {1: (8, _GREY), 2: (16, _GREY), 3: (8, _RGB), 4: (8, _RGBA), 6: (16, _RGB), 8: (16, _RGBA)}
"""Bits and kind of colour of a picture with this many bytes a pixel, whose filters are the same."""

Chunk = tuple[bytes, bytes | memoryview]


class _Header(NamedTuple):
    columns: int
    rows: int
    bits: int
    colour: int
    compression: int = 0
    filters: int = 0
    interlaced: int = 0


def png_bands(data: bytes) -> Bands:
    """Cut a PNG into bands. Raises: WholePieceError if it is interlaced; ValueError or struct.error if damaged."""
    from PIL.Image import Exif

    chunks = _chunks(data)
    name, start = next(chunks)
    if name != b"IHDR" or len(start) != 13:
        raise ValueError("its header is missing")
    header = _Header._make(struct.unpack(">IIBBBBB", start))
    if header.interlaced:
        raise WholePieceError("save it without interlacing")
    exif, colours, packed = Exif(), list[Chunk](), list[memoryview]()
    for name, content in chunks:
        if name == b"IDAT":
            packed.append(content)
        elif name in (b"PLTE", b"tRNS"):
            colours.append((name, content))
        elif name == b"eXIf":
            exif.load(bytes(content))
    return Bands(header.rows, header.columns, exif.get(_ORIENTATION, 1), _bands(header, colours, packed))


def _chunks(data: bytes) -> Iterator[tuple[bytes, memoryview]]:
    """Yield the name and the content of each chunk up to the end."""
    at, view = len(SIGNATURE), memoryview(data)
    while at + 8 <= len(data):
        length, name = struct.unpack_from(">I4s", data, at)
        yield name, view[at + 8 : at + 8 + length]
        at += 12 + length


def _bands(header: _Header, colours: list[Chunk], packed: list[memoryview]) -> Iterator[bytes]:
    bits = header.bits * _CHANNELS[header.colour]
    line = 1 + -(-header.columns * bits // 8)
    most = max(8, BAND_PIXELS // header.columns)
    check_size((most, header.columns, _CHANNELS[header.colour]), -(-header.bits // 8))
    lines = np.zeros((1, line), np.uint8)
    unpacked = _unpacked(packed, line * most)
    for first in range(0, header.rows, most):
        rows = min(most, header.rows - first)
        filtered = np.frombuffer(next(unpacked, b"")[: rows * line], np.uint8)
        if filtered.size != rows * line:
            raise ValueError("its rows end early")
        lines = _without_filters(np.concatenate([lines[-1:], filtered.reshape(rows, line)]), max(1, bits // 8))
        yield _file(header._replace(rows=rows), lines[1:], colours)


def _without_filters(lines: np.ndarray, step: int) -> np.ndarray:
    """Return rows of bytes as they are without the filter that their first column names; it is 0 in the result.

    A filter adds bytes that are above, or `step` to the left, whatever they mean: so OpenCV decodes them as the pixels
    of a picture without a palette. The first row has no filter. Raises: ValueError if a filter is unknown.
    """
    if lines[:, 0].max() > 4:
        raise ValueError("a row has an unknown filter")
    rows, line = lines.shape
    file = _file(_Header((line - 1) // step, rows, *_STAND_IN[step]), lines, [])
    with silent_opencv():
        values = cast(np.ndarray, cv2.imdecode(np.frombuffer(file, np.uint8), cv2.IMREAD_UNCHANGED))
        if values.ndim == 3:
            values = cv2.cvtColor(values, cv2.COLOR_BGRA2RGBA if values.shape[2] == 4 else cv2.COLOR_BGR2RGB)
    whole = np.frombuffer(values.astype(values.dtype.newbyteorder(">")).tobytes(), np.uint8)
    return np.pad(whole.reshape(rows, line - 1), ((0, 0), (1, 0)))


def _unpacked(packed: list[memoryview], most: int) -> Iterator[bytes]:
    """Yield the decompressed bytes, `most` at a time; the last are fewer."""
    stream, ready = zlib.decompressobj(), bytearray()
    for piece in (*packed, b""):
        left: bytes | memoryview = piece
        while True:
            ready += stream.decompress(left, most - len(ready))
            if len(ready) < most:
                break
            yield bytes(ready)
            ready.clear()
            left = stream.unconsumed_tail
    yield bytes(ready)


def _file(header: _Header, lines: np.ndarray, colours: list[Chunk]) -> bytes:
    pixels = zlib.compress(lines.tobytes(), 0)
    chunks = [(b"IHDR", struct.pack(">IIBBBBB", *header)), *colours, (b"IDAT", pixels), (b"IEND", b"")]
    return SIGNATURE + b"".join(
        struct.pack(">I", len(content)) + name + content + struct.pack(">I", zlib.crc32(content, zlib.crc32(name)))
        for name, content in chunks
    )
