"""A large picture as bands of rows, a PNG also as small picture files, and the reduction of bands.

Source: PNG, third edition, sections 5 (chunks), 8 (interlacing) and 9 (filters).
"""

import struct
import zlib
from collections.abc import Iterable, Iterator
from typing import NamedTuple, cast

import cv2
import numpy as np

from ...files.reading import check_size
from ...runtime.opencv import plain_opencv, silent_opencv

# The pixels of a band, about: what is in memory next to the file and the reduced picture.
BAND_PIXELS = 4_000_000
_AVERAGED = ("uint8", "uint16", "float32")  # types of numbers that OpenCV averages without another copy
PNG = b"\x89PNG\r\n\x1a\n"
_ORIENTATION = 0x0112  # tag of EXIF
_GREY, _RGB, _RGBA = 0, 2, 6
_CHANNELS = {_GREY: 1, _RGB: 3, 3: 1, 4: 2, _RGBA: 4}  # channels by the kind of colour
_STAND_IN = {1: (8, _GREY), 2: (16, _GREY), 3: (8, _RGB), 4: (8, _RGBA), 6: (16, _RGB), 8: (16, _RGBA)}
"""Bits and kind of colour of a picture with this many bytes a pixel, whose filters are the same."""

Chunk = tuple[bytes, bytes | memoryview]


class WholePieceError(ValueError):
    """A large picture is stored so that its rows cannot be decoded one after another; the message names the cure."""


def reduced(bands: Iterable[np.ndarray], rows: int, columns: int, times: int) -> np.ndarray:
    """Return the mean of each square of `times` x `times` pixels; raise ValueError for fewer than `rows` rows."""
    small, rest, row_count = np.empty(0), np.empty(0), 0
    for band in bands:
        together = np.concatenate([rest, band]) if rest.size else band
        if not small.size:
            small = np.empty((-(-rows // times), -(-columns // times), *band.shape[2:]), band.dtype)
        whole = len(together) // times * times
        row_count += _fill(small[row_count:], together[:whole], times)
        rest = together[whole:]
    row_count += _fill(small[row_count:], rest, times)
    if row_count < -(-rows // times):
        raise ValueError("its rows end early")
    return small


def _fill(small: np.ndarray, band: np.ndarray, times: int) -> int:
    """Write the means of a band to the first rows of `small`; return how many rows these are."""
    row_count = min(-(-len(band) // times), len(small))
    if not row_count:
        return 0
    down, right = row_count * times - len(band), small.shape[1] * times - band.shape[1]
    numbers = band if band.dtype.name in _AVERAGED else band.astype(np.float64)
    with plain_opencv():
        padded = cv2.copyMakeBorder(numbers, 0, down, 0, right, cv2.BORDER_REPLICATE) if down or right else numbers
        mean = cv2.resize(padded, (small.shape[1], row_count), interpolation=cv2.INTER_AREA)
    small[:row_count] = mean.reshape(small[:row_count].shape)
    return row_count


class _Header(NamedTuple):
    columns: int
    rows: int
    bits: int
    colour: int
    compression: int = 0
    filters: int = 0
    interlaced: int = 0


def png_bands(data: bytes) -> tuple[int, Iterator[bytes]]:
    """Return the EXIF orientation of a PNG, and its bands, each the bytes of a PNG. Raises: WholePieceError."""
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
    return exif.get(_ORIENTATION, 1), _bands(header, colours, packed)


def _chunks(data: bytes) -> Iterator[tuple[bytes, memoryview]]:
    """Yield the name and the content of each chunk up to the end."""
    at, view = len(PNG), memoryview(data)
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
    unpacked = _unpack(packed, line * most)
    for first in range(0, header.rows, most):
        rows = min(most, header.rows - first)
        filtered = np.frombuffer(next(unpacked, b"")[: rows * line], np.uint8)
        if filtered.size != rows * line:
            raise ValueError("its rows end early")
        lines = _without_filters(np.concatenate([lines[-1:], filtered.reshape(rows, line)]), max(1, bits // 8))
        yield _file(header._replace(rows=rows), lines[1:], colours)


def _without_filters(lines: np.ndarray, step: int) -> np.ndarray:
    """Return rows of bytes without the filter that their first column names, 0 in the result. Raises: ValueError."""
    # A filter adds bytes that are above, or `step` to the left, whatever they mean: so OpenCV decodes them as
    # pixels of a picture without a palette. The first row has no filter.
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


def _unpack(packed: list[memoryview], most: int) -> Iterator[bytes]:
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
    return PNG + b"".join(
        struct.pack(">I", len(content)) + name + content + struct.pack(">I", zlib.crc32(content, zlib.crc32(name)))
        for name, content in chunks
    )
