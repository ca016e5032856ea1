"""Files of vectors, read by their kind."""

from pathlib import Path

from ..formats.multi_picture import Notify, ignore
from .page import VectorPage
from .pdf import read_pdf
from .svg import read_svg


def is_vectors(path: Path) -> bool:
    """Tell whether a file is one of vectors, by its name."""
    return path.suffix.lower() in (".svg", ".pdf")


def read_vectors(path: Path, data: bytes, page: int | None = None, notify: Notify = ignore) -> VectorPage:
    """Read an SVG, or a page of a PDF, from 1. Nothing outside of the file is read.

    Raises: PictureError, with the cure, for what cannot be read or shows nothing.
    """
    if path.suffix.lower() == ".pdf":
        return read_pdf(path, data, page, notify)
    return read_svg(path, data, notify)
