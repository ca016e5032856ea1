"""A sheet as a file: PNG, SVG or PDF, each with a title and a description for people who do not see it."""

from __future__ import annotations

from collections.abc import Callable
from io import BytesIO
from pathlib import Path
from typing import IO, TYPE_CHECKING
from xml.sax.saxutils import escape

import numpy as np

from tangible_core.errors import OutputError

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Write = Callable[["Figure", IO[bytes], str, str], None]

RUNS = 3
"""zlib's strategy for PNG, Z_RLE: runs of one value. At level 1 it takes a sixth of the time of matplotlib's PNG, for a
smaller file; the sheet is opaque, so that its alpha is left out."""


def describe_sheet(figure: Figure) -> str:
    """Return a description of a sheet in words: each panel's headline, its caption and its legend."""
    title, *texts = (text.get_text() for text in figure.texts)
    panels: list[str] = []
    for headline, axes in zip(texts[1::2], figure.axes, strict=False):
        legend = axes.get_legend()
        caption = [] if len(axes.get_xticks()) else [axes.get_xlabel()]
        parts = [*caption, *(text.get_text() for text in (legend.get_texts() if legend else ()))]
        panels.append(": ".join(filter(None, (headline, "; ".join(filter(None, parts))))))
    pictures = "one picture" if len(panels) == 1 else f"{len(panels)} pictures"
    return f"A sheet of {pictures} of {title or 'a run'}. {'. '.join(panels)}."


def writer(path: Path) -> Write:
    """Return the function that writes sheets of this suffix. Raises: OutputError if there is none."""
    if path.suffix not in WRITERS:
        raise OutputError(f"{path}: a sheet is drawn as .png, .svg or .pdf; change the end of the name")
    return WRITERS[path.suffix]


def _png(figure: Figure, file: IO[bytes], title: str, says: str) -> None:
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from PIL import Image
    from PIL.PngImagePlugin import PngInfo

    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    words = PngInfo()
    for key, text in (("Title", title), ("Description", says)):
        words.add_text(key, text)
    opaque = Image.fromarray(np.asarray(canvas.buffer_rgba())[..., :3])
    opaque.save(file, "png", pnginfo=words, dpi=(figure.dpi, figure.dpi), compress_level=1, compress_type=RUNS)


def _svg(figure: Figure, file: IO[bytes], title: str, says: str) -> None:
    """Write an SVG with <title> and <desc> at the top, for screen readers."""
    from matplotlib.backends.backend_svg import FigureCanvasSVG

    content = BytesIO()
    FigureCanvasSVG(figure).print_svg(content, metadata={"Date": None})
    head, start, rest = content.getvalue().decode().partition("<svg ")
    attributes, end, body = rest.partition(">")
    words = f"\n <title>{escape(title)}</title>\n <desc>{escape(says)}</desc>"
    file.write(f'{head}{start}role="img" {attributes}{end}{words}{body}'.encode())


def _pdf(figure: Figure, file: IO[bytes], title: str, says: str) -> None:
    from matplotlib.backends.backend_pdf import FigureCanvasPdf

    content = BytesIO()  # on a full disk, the backend raises an error of zlib
    FigureCanvasPdf(figure).print_pdf(content, metadata={"Title": title, "Subject": says, "CreationDate": None})
    file.write(content.getvalue())


WRITERS: dict[str, Write] = {".png": _png, ".svg": _svg, ".pdf": _pdf}
