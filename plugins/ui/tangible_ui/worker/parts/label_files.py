"""Label pictures as a page uploads them, and as files: `parts.png`, which paint programs open and pipelines read."""

import hashlib
import struct
import zlib
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from jaxtyping import Int32, UInt16

from tangible_authoring.label_picture import label_picture
from tangible_core.errors import ConfigError
from tangible_core.files import MOST_PIXELS
from tangible_core.scene.formats import MAX_LABELS

NAME = "parts.png"
GZIP = 31
"""Window bits with which zlib takes gzip files alone."""
PNG = b"\x89PNG\r\n\x1a\n"
AFTER_SIZE = len(PNG) + 4 + 4 + 13 + 4
"""Offset of a PNG's second chunk; the first one holds its size."""
_TEXT, _PIXELS = b"tEXt", b"IDAT"


def unpack(path: Path, shape: tuple[int, int]) -> UInt16[np.ndarray, "h w"]:
    """Unpack labels that a page has uploaded: uint16, little-endian, row by row, as gzip.

    At most one byte too many is unpacked. Raises: ConfigError for anything else, and another size.
    """
    size = 2 * shape[0] * shape[1]
    wrong = f"the labels that were sent are not a gzip of {shape[1]} x {shape[0]} numbers of two bytes; send them again"
    if not 0 < size <= 2 * MOST_PIXELS:
        raise ConfigError(wrong)
    try:
        unpacking = zlib.decompressobj(GZIP)
        with path.open("rb") as file:
            found = unpacking.decompress(file.read(size + size // 1000 + 1024), size + 1)
    except (zlib.error, OSError) as error:
        raise ConfigError(wrong) from error
    if len(found) != size or not unpacking.eof:
        raise ConfigError(wrong)
    return np.frombuffer(found, "<u2").reshape(shape).astype(np.uint16, copy=False)


def as_png(labels: Int32[np.ndarray, "h w"], document: str) -> bytes:
    """Return a PNG of labels, marked with the pipeline file that it belongs to.

    document: name of that file. Raises: ConfigError for more labels than a picture may hold.
    """
    count = int(labels.max(initial=0)) + 1
    if count > MAX_LABELS:
        raise ConfigError(f"these are {count} parts, and at most {MAX_LABELS} are allowed; join some of them")
    picture = label_picture(np.ascontiguousarray(labels))
    return picture[:AFTER_SIZE] + _chunk(_TEXT, _mark(picture, document)) + picture[AFTER_SIZE:]


def is_ours(path: Path, document: str) -> bool:
    """Return True if the file is as `as_png` made it for this pipeline file: nobody has painted in it since."""
    try:
        picture = path.read_bytes()
    except OSError:
        return False
    return (_TEXT, _mark(picture, document)) in _chunks(picture)


def _mark(picture: bytes, document: str) -> bytes:
    """Return the mark of a PNG's pixels and of the file that it belongs to."""
    digest = hashlib.sha256(document.encode(errors="surrogateescape"))
    for kind, data in _chunks(picture):
        if kind == _PIXELS:
            digest.update(data)
    return b"Tangible Images\0parts " + digest.hexdigest().encode()


def _chunks(picture: bytes) -> Iterator[tuple[bytes, bytes]]:
    """Yield kind and data of each chunk of a PNG; nothing for other data."""
    at = len(PNG) if picture.startswith(PNG) else len(picture)
    while at + 8 <= len(picture):
        size, kind = struct.unpack_from(">I4s", picture, at)
        yield kind, picture[at + 8 : at + 8 + size]
        at += 12 + size


def _chunk(kind: bytes, data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
