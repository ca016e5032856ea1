"""Grids of heights as geographers exchange them: ESRI ASCII (.asc), SRTM (.hgt), and .bil and .flt with their .hdr.

Sources: Esri, ASCII raster format, BIL, BIP and BSQ raster files; NASA/USGS, SRTM quickstart.
"""

import re
from collections.abc import Mapping
from math import isqrt, prod
from pathlib import Path

import numpy as np

from ...files.reading import MAX_TEXT_BYTES, check_size, read_bytes
from .map_numbers import is_nodata
from .tiff import UnreadableError

GRIDS = frozenset((".hgt", ".bil", ".flt"))  # suffixes of grids whose first bytes do not tell what they are
_LINE = re.compile(rb"[ \t]*([a-zA-Z_]\w{0,30})[ \t]+(\S{1,60})[ \t]*(?:\r\n|\n|\r)")
_ESRI_NODATA, _SRTM_VOID = -9999.0, -32768.0
_PIXELS: Mapping[str, str] = {"SIGNEDINT": "i", "UNSIGNEDINT": "u", "FLOAT": "f"}


def read_grid(path: Path, data: bytes) -> np.ndarray:
    """Read a grid, masked where it has no data. Raises: UnreadableError without its header; others if damaged."""
    suffix = path.suffix.lower()
    header = grid_header(path, data)
    if suffix == ".hgt":
        side = isqrt(len(data) // 2)
        if 2 * side * side != len(data) or side < 2:
            raise ValueError(f"{len(data)} bytes are not a square of heights of 16 bits")
        values = np.frombuffer(data, ">i2").reshape(side, side)
    else:
        shape = int(header["nrows"]), int(header["ncols"])
        check_size(shape, 8)
        values = (
            _binary_numbers(header, data, shape, suffix) if suffix in (".bil", ".flt") else _ascii_numbers(data, shape)
        )
    nodata = float(header.get("nodata_value", header.get("nodata", _SRTM_VOID if suffix == ".hgt" else _ESRI_NODATA)))
    values = values.astype(values.dtype.newbyteorder("="))
    return np.ma.masked_array(values, is_nodata(values, nodata))


def grid_header(path: Path, data: bytes) -> Mapping[str, str]:
    """Return a grid's header by names in lower case, or that of the .hdr beside it. Raises: UnreadableError."""
    suffix = path.suffix.lower()
    if suffix == ".hgt":
        return {}
    if suffix in (".bil", ".flt"):
        beside = next((path.with_suffix(end) for end in (".hdr", ".HDR") if path.with_suffix(end).is_file()), None)
        if beside is None:
            raise UnreadableError(f"its header {path.with_suffix('.hdr').name} is missing; put it next to the file")
        data = read_bytes(beside, MAX_TEXT_BYTES) + b"\n"
    words: dict[str, str] = {}
    at = 0
    while line := _LINE.match(data, at):
        words[line[1].decode().lower()] = line[2].decode()
        at = line.end()
    return words


def _binary_numbers(header: Mapping[str, str], data: bytes, shape: tuple[int, int], suffix: str) -> np.ndarray:
    if int(header.get("nbands", 1)) != 1:
        raise UnreadableError(f"holds {header['nbands']} bands; save one of them")
    kind = "f" if suffix == ".flt" else _PIXELS[header.get("pixeltype", "UNSIGNEDINT").upper()]
    bits = 32 if suffix == ".flt" else int(header.get("nbits", 8))
    order = ">" if header.get("byteorder", "I").upper() in ("M", "MSBFIRST") else "<"
    return np.frombuffer(data, f"{order}{kind}{bits // 8}", prod(shape), int(header.get("skipbytes", 0))).reshape(shape)


def _ascii_numbers(data: bytes, shape: tuple[int, int]) -> np.ndarray:
    """Read the numbers of an ASCII grid, with a decimal point or comma."""
    at = 0
    while line := _LINE.match(data, at):
        at = line.end()
    words = data[at:].replace(b",", b".").split()
    if len(words) != prod(shape):
        raise ValueError(f"it has {len(words)} numbers, and its header says {shape[0]} x {shape[1]}")
    return np.array(words, np.float64).reshape(shape)
