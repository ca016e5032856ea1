"""Tests that a file is whole, by the structure of its format."""

import json
import struct
import zipfile
from collections.abc import Callable
from pathlib import Path
from xml.etree import ElementTree

from ..checks import demand


def demand_whole(path: Path) -> None:
    """Demand that a file is neither empty nor truncated, and of the format that its ending names.

    Raises: CheckFailure, or the exception of the reader.
    """
    demand(path.stat().st_size > 0, f"{path.name} is empty")
    if (read := READERS.get(path.suffix.lower())) is not None:
        read(path)


def _json(path: Path) -> None:
    def refuse(word: str) -> None:
        raise ValueError(f"{path.name} contains {word}, which is not JSON")

    json.loads(path.read_text(encoding="utf-8"), parse_constant=refuse)


def _xml(path: Path) -> None:
    ElementTree.parse(path)


def _picture(path: Path) -> None:
    from PIL import Image

    with Image.open(path) as image:
        image.load()


def _zip(path: Path) -> None:
    with zipfile.ZipFile(path) as archive:
        demand(archive.testzip() is None, f"{path.name}: {archive.testzip()} within it is damaged")


def _stl(path: Path) -> None:
    """Compare the size of a binary STL with the number of triangles that it states."""
    data = path.read_bytes()
    (count,) = struct.unpack_from("<I", data, 80)
    demand(len(data) == 84 + 50 * count, f"{path.name} states {count} triangles, but has {len(data)} bytes")


def _glb(path: Path) -> None:
    data = path.read_bytes()
    magic, _, length = struct.unpack_from("<4sII", data)
    demand(magic == b"glTF", f"{path.name} does not begin as a GLB does")
    demand(length == len(data), f"{path.name} states {length} bytes, but has {len(data)}")


def _pdf(path: Path) -> None:
    data = path.read_bytes()
    demand(data.startswith(b"%PDF-"), f"{path.name} does not begin as a PDF does")
    demand(data.rstrip().endswith(b"%%EOF"), f"{path.name} does not end as a PDF does")


def _text(path: Path) -> None:
    path.read_text(encoding="utf-8")


READERS: dict[str, Callable[[Path], None]] = {
    ".json": _json, ".svg": _xml, ".xml": _xml, ".png": _picture, ".tif": _picture, ".tiff": _picture, ".jpg": _picture,
    ".zip": _zip, ".3mf": _zip, ".stl": _stl, ".glb": _glb, ".pdf": _pdf, ".txt": _text, ".html": _text, ".csv": _text,
}  # fmt: skip
