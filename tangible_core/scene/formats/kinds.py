"""What a file is, by its first bytes; by the end of its name only where these do not tell."""

import re
from contextlib import suppress
from pathlib import Path
from typing import Literal

from .heif import HEIC
from .netpbm import NETPBM
from .tiff import TIFF, holds_heights

FileKind = Literal["picture", "heights", "video"]

PICTURES = frozenset(
    (
        ".png", ".jpg", ".jpeg", ".jpe", ".jfif", ".mpo", ".jps", ".jp2", ".j2k", ".webp", ".bmp", ".gif", ".tif",
        ".tiff", ".ppm", ".pgm", ".pbm", ".pnm", ".heic", ".heif", ".avif", ".svg", ".pdf",
    )
)  # fmt: skip
"""Suffixes of pictures; a file with another one is a picture if its first bytes say so."""
VIDEOS = frozenset((".mp4", ".m4v", ".mov", ".avi", ".mkv", ".webm", ".mpg", ".mpeg", ".wmv", ".ogv", ".3gp", ".mts"))
"""Suffixes of videos."""
MAPS = frozenset((".npy", ".npz", ".pfm", ".asc", ".hgt", ".bil", ".flt"))
"""Suffixes of maps of heights; a TIFF of signed numbers, of floating point or of a place on earth is one as well."""

PNG, JPEG = b"\x89PNG\r\n\x1a\n", b"\xff\xd8\xff"
NPY, ZIP = b"\x93NUMPY", b"PK\x03\x04"  # the first bytes of a PNG, a JPEG, and of .npy and .npz
# The first bytes of a JPEG 2000, with and without its boxes.
JPEG_2000 = (b"\0\0\0\x0cjP  ", b"\xff\x4f\xff\x51")
ASC = re.compile(rb"\s*ncols\s+\d", re.IGNORECASE)  # the start of an ESRI ASCII grid
# The root of an SVG behind a declaration, a type and comments, none of which is tried twice: a file may be hostile.
SVG = re.compile(rb"(\xef\xbb\xbf)?(\s|<!--.*?-->|<[?!](?!--)[^>]*>)*+<(\w+:)?svg[\s>]", re.DOTALL)
PDF = b"%PDF-"
_HEAD = 1024
_PICTURES = (
    PNG, JPEG, b"GIF8", b"BM", *JPEG_2000, b"P1", b"P4", *NETPBM, PDF
)  # fmt: skip
_VIDEOS = (b"\x1aE\xdf\xa3", b"\0\0\x01\xba", b"\0\0\x01\xb3", b"OggS", b"0&\xb2u")
_STILL = (b"avif", b"avis", *HEIC)  # brands of ISO's media files that are pictures


def file_kind(path: Path) -> FileKind | None:
    """Return what a file is; by its name alone if it cannot be read; None for another kind."""
    suffix, head = path.suffix.lower(), _first_bytes(path)
    suffix_kind = (
        "picture" if suffix in PICTURES else "video" if suffix in VIDEOS else "heights" if suffix in MAPS else None
    )
    if head[:4] in TIFF:
        return "heights" if holds_heights(path) else "picture"
    if head[:2] in (b"Pf", b"PF") or head[:6] == NPY or ASC.match(head):
        return "heights"
    if head[:4] == b"RIFF":
        return "picture" if head[8:12] == b"WEBP" else "video"
    if head[4:8] == b"ftyp":
        return "picture" if head[8:12] in _STILL else "video"
    if (head.startswith(_PICTURES) and suffix_kind != "video") or SVG.match(head):
        return "picture"
    return "video" if head.startswith(_VIDEOS) else suffix_kind


def vector_format(path: Path) -> Literal["svg", "pdf"] | None:
    """Return the format of a drawing in vectors, by its name where the first bytes are of nothing; None for another."""
    head, suffix = _first_bytes(path), path.suffix.lower()
    if head.startswith(PDF) or SVG.match(head):
        return "pdf" if head.startswith(PDF) else "svg"
    named: dict[str, Literal["svg", "pdf"]] = {".svg": "svg", ".pdf": "pdf"}
    return None if head.startswith(_PICTURES) else named.get(suffix)


def is_binary(path: Path) -> bool:
    """Return True for a file that is not a text, such as a picture of a kind that is not read."""
    return b"\0" in _first_bytes(path)


def _first_bytes(path: Path) -> bytes:
    with suppress(OSError, ValueError):
        if path.is_file():
            with path.open("rb") as file:
                return file.read(_HEAD)
    return b""
