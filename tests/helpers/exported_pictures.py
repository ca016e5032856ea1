"""Works of the three pictures with parts drawn by hand, for exporters; and exported files as pixels."""

import subprocess
from functools import cache
from pathlib import Path

import cv2
import numpy as np

from drawn_parts import drawn
from tangible_core.data import PartMap, Relief, Work
from tangible_core.parts import SimplifyChoice
from tangible_core.plugins.interfaces import Exporter
from tangible_legibility import simplify

PICTURES = ("astronaut", "coffee", "motorcycle")


@cache
def simplified(name: str, width_m: float) -> PartMap:
    """Return the simplified parts, as the pipeline makes them."""
    made = drawn(name)
    return simplify(made.parts, width_m, SimplifyChoice(), made.names)


def work_of(name: str, exporter: Exporter) -> Work:
    """Return a work with the products that this exporter needs, made for its width."""
    made = drawn(name)
    rows, columns = made.parts.labels.shape
    width_m = exporter.picture_width_m(columns / rows)
    heights = np.float32(made.heights_m)[made.parts.labels]
    products = {"simplified": simplified(name, width_m), "relief": Relief(heights, (width_m, width_m * rows / columns))}
    needed = {need: products[need] for need in exporter.needs}
    return Work(name.capitalize(), "en", needed, made.picture, made.names)


def labels_work(labels: np.ndarray, names: tuple[str, ...] = (), title: str = "Map", language: str = "en") -> Work:
    """Return a work of a map of labels, each a part."""
    parts = PartMap(np.asarray(labels, np.int32), tuple(range(int(labels.max()) + 1)))
    return Work(title, language, {"simplified": parts}, None, names)


def pixels(svg: Path, per_inch: float) -> np.ndarray:
    """Return an SVG in millimetres as grey levels, drawn by librsvg."""
    words = ["rsvg-convert", "-d", f"{per_inch}", "-p", f"{per_inch}", "-b", "white", str(svg)]
    return _decode(subprocess.run(words, check=True, capture_output=True).stdout)[..., 0]


def alpha(svg: Path, columns: int, rows: int) -> np.ndarray:
    """Return the alpha of an SVG at one pixel a unit, drawn by librsvg."""
    words = ["rsvg-convert", "-w", f"{columns}", "-h", f"{rows}", str(svg)]
    return _decode(subprocess.run(words, check=True, capture_output=True).stdout)[..., 3]


def pdf_pixels(pdf: Path, page: int, per_inch: float) -> np.ndarray:
    """Return a page of a PDF as grey levels, drawn by poppler."""
    words = ["pdftoppm", "-r", f"{per_inch}", "-f", f"{page}", "-l", f"{page}", "-gray", "-png", str(pdf)]
    return _decode(subprocess.run(words, check=True, capture_output=True).stdout)[..., 0]


def _decode(png: bytes) -> np.ndarray:
    picture = cv2.imdecode(np.frombuffer(png, np.uint8), cv2.IMREAD_UNCHANGED)
    return picture[..., None] if picture.ndim == 2 else picture
