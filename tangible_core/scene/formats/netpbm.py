"""Netpbm's maps: PGM and PPM with any number for white, and PFM, whose numbers are floating point.

Sources: netpbm.sourceforge.net, pgm(5), ppm(5); pauldebevec.com, Portable FloatMap.
"""

import re
from math import isfinite, prod

import numpy as np

from ...files.reading import check_size

# The first bytes of these files; Pillow reads P1 and P4, which are black and white.
NETPBM = (b"P2", b"P3", b"P5", b"P6", b"Pf", b"PF")
_GAP = rb"(?:\s|#[^\n\r]*[\n\r])+"
_HEAD = re.compile(rb"P([2356Ff])" + _GAP + _GAP.join([rb"(\d{1,9})"] * 2) + _GAP + rb"([-+.\deE]{1,40})\s")


def read_netpbm(data: bytes) -> tuple[np.ndarray, int | None]:
    """Read numbers as stored, (h, w[, 3]), and that of white, None for floats. Raises: ValueError, TooLargeError."""
    head = _HEAD.match(data)
    if head is None:
        raise ValueError("its header is damaged")
    columns, rows, white = int(head[2]), int(head[3]), float(head[4])
    shape = (rows, columns, 3) if head[1] in b"36F" else (rows, columns)
    if not prod(shape) or not isfinite(white) or white == 0:
        raise ValueError("its header is damaged")
    if head[1] in b"Ff":
        values = _binary_numbers(data, head, shape, "<f4" if white < 0 else ">f4")
        return values[::-1].astype(np.float32), None  # the lowest row is the first
    if not 1 <= white <= 0xFFFF:
        raise ValueError(f"its number for white is {white:g}")
    values = (
        _ascii_numbers(data, head, shape)
        if head[1] in b"23"
        else _binary_numbers(data, head, shape, "u1" if white < 256 else ">u2")
    )
    if values.max() > white:
        raise ValueError(f"it holds {values.max()}, and white is {white:g}")
    return values.astype(np.uint8 if white < 256 else np.uint16), int(white)


def _binary_numbers(data: bytes, head: re.Match[bytes], shape: tuple[int, ...], dtype: str) -> np.ndarray:
    """Read binary numbers behind the header, which another system may have ended with two characters."""
    check_size(shape, np.dtype(dtype).itemsize)
    size, start = prod(shape) * np.dtype(dtype).itemsize, head.end()
    if data[start - 1 : start + 1] == b"\r\n" and len(data) > start + size:
        start += 1
    return np.frombuffer(data, dtype, prod(shape), start).reshape(shape)


def _ascii_numbers(data: bytes, head: re.Match[bytes], shape: tuple[int, ...]) -> np.ndarray:
    """Read numbers that are written in digits."""
    check_size(shape, 2)
    digits = re.sub(rb"#[^\n\r]*", b"", data[head.end() :]).split(None, prod(shape))[: prod(shape)]
    return np.array(digits, "S5").astype(np.uint32).reshape(shape)
