"""Whether a file is whole, by what its kind of file says of itself."""

import json
import struct
import zipfile
from collections.abc import Callable
from pathlib import Path
from xml.etree import ElementTree

from ..checks import demand


def demand_whole(path: Path) -> None:
    """Raises: CheckFailure, or what reading it raises, for a file that is empty, cut short or not of its kind."""
    demand(path.stat().st_size > 0, f"{path.name} is empty")
    if (look := KINDS.get(path.suffix.lower())) is not None:
        look(path)


def _json(path: Path) -> None:
    def refuse(word: str) -> None:
        raise ValueError(f"{path.name} holds {word}, which JSON has not")

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
    """A binary one says how many triangles it has."""
    data = path.read_bytes()
    (count,) = struct.unpack_from("<I", data, 80)
    demand(len(data) == 84 + 50 * count, f"{path.name} says it has {count} triangles, and has {len(data)} bytes")


def _glb(path: Path) -> None:
    data = path.read_bytes()
    magic, _, length = struct.unpack_from("<4sII", data)
    demand(magic == b"glTF", f"{path.name} does not begin as a GLB does")
    demand(length == len(data), f"{path.name} says it has {length} bytes, and has {len(data)}")


def _pdf(path: Path) -> None:
    data = path.read_bytes()
    demand(data.startswith(b"%PDF-"), f"{path.name} does not begin as a PDF does")
    demand(data.rstrip().endswith(b"%%EOF"), f"{path.name} does not end as a PDF does")


def _text(path: Path) -> None:
    path.read_text(encoding="utf-8")


KINDS: dict[str, Callable[[Path], None]] = {
    ".json": _json, ".svg": _xml, ".xml": _xml, ".png": _picture, ".tif": _picture, ".tiff": _picture, ".jpg": _picture,
    ".zip": _zip, ".3mf": _zip, ".stl": _stl, ".glb": _glb, ".pdf": _pdf, ".txt": _text, ".html": _text, ".csv": _text,
}  # fmt: skip
