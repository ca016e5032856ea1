"""Marks as figures of matplotlib: for the PDF, and for the pixels by which a page is measured."""

from collections.abc import Sequence
from io import BytesIO
from pathlib import Path

import numpy as np
from jaxtyping import Bool
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.backends.backend_pdf import PdfPages
from matplotlib.figure import Figure
from matplotlib.patches import PathPatch
from matplotlib.path import Path as Shape
from matplotlib.transforms import Affine2D

from .reading import Mark, Marks

MM_PER_INCH = 25.4
POINTS_PER_MM = 72 / MM_PER_INCH


def write_pdf(path: Path, pages: Sequence[Marks]) -> None:
    """Write all pages as lines and areas, without pictures and fonts; the same pages give the same bytes."""
    save_pdf(path, pages[0].title, [make_figure(page, page.marks) for page in pages])


def save_pdf(path: Path, title: str, figures: Sequence[Figure]) -> None:
    """Write each figure as a page of a PDF that has no time in it."""
    about = {"Title": title, "Creator": "Tangible Images", "CreationDate": None}
    buffer = BytesIO()  # on a full disk, PdfPages raises an error of zlib
    with PdfPages(buffer, metadata=about) as file:
        for figure in figures:
            file.savefig(figure)
    path.write_bytes(buffer.getvalue())


def black(page: Marks, pixels_per_mm: int) -> Bool[np.ndarray, "r c"]:
    """Return the pixels that ink covers by half or more."""
    figure = make_figure(page, page.marks, pixels_per_mm * MM_PER_INCH)
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    return np.asarray(canvas.buffer_rgba())[..., 3] > 127


def make_figure(page: Marks, marks: Sequence[Mark], pixels_per_inch: float = 72, colour: str = "black") -> Figure:
    """Return marks of a page as a figure of its size."""
    width, length = page.size_mm
    figure = Figure(figsize=(width / MM_PER_INCH, length / MM_PER_INCH), dpi=pixels_per_inch, facecolor="none")
    to_page = Affine2D().scale(1 / width, -1 / length).translate(0, 1) + figure.transFigure
    for stroke_mm in sorted({mark.stroke_mm for mark in marks}):
        shape = Shape.make_compound_path(*(mark.shape for mark in marks if mark.stroke_mm == stroke_mm))
        shape.should_simplify = False
        patch = PathPatch(
            shape,
            fill=not stroke_mm,
            facecolor=colour,
            edgecolor=colour if stroke_mm else "none",
            linewidth=stroke_mm * POINTS_PER_MM,
            capstyle="round",
            joinstyle="round",
            snap=False,
            transform=to_page,
        )
        figure.add_artist(patch)
    return figure
