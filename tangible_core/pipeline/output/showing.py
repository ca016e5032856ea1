"""Pictures of single products, in matplotlib and in notebooks, drawn by the exporter `sheet`."""

from __future__ import annotations

import base64
import logging
from contextlib import suppress
from dataclasses import fields
from html import escape
from io import BytesIO
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from ...data import MaterialMap, Record
from ...data.outcome import html_table
from ...errors import BrokenMethod, OutputError
from ...plugins.interfaces import Drawing, Exporter
from ...plugins.notes import note
from ...plugins.registry import Registry, default_registry
from ...session import Recording
from ..feel_options import Felt

if TYPE_CHECKING:
    from matplotlib.axes import Axes

log: logging.Logger = logging.getLogger(__name__)

SHEET = "sheet"
DPI = 80


def can_draw(registry: Registry) -> bool:
    """Return True if the exporter that draws is installed; else a run has no sheet, and a note gives the reason."""
    if SHEET in registry.names("export"):
        return True
    note(log, f"no sheet is drawn: no exporter named {SHEET!r} is installed")
    return False


def drawing(**options: Any) -> Drawing:
    """Load the exporter that draws. Raises: UnknownMethod, BrokenMethod."""
    sheet: type[Exporter] = cast("type[Exporter]", default_registry().load("export", SHEET))
    if not issubclass(sheet, Drawing):
        raise BrokenMethod(f"export method {SHEET!r} is not a Drawing; rename it, as runs are drawn by this name")
    return sheet(**options)


def show(product: Record | Felt, axes: Axes | None = None, **others: Any) -> Axes:
    """Draw a product as its panel on the sheet of a run, with units and a title, and return the axes.

    product: of a pipeline, its surface is drawn.
    axes: the axes to draw into; None makes a pyplot figure of the panel's proportions.
    others: further products for the panel, by name: `views` and `materials` with segments, `views` and `surface` with
    parts, `relief` with a recording.
    Raises: OutputError for a product without a picture, such as materials without segments.
    """
    return drawing().show(product.make("surface") if isinstance(product, Felt) else product, axes, **others)


def as_html(record: Record) -> str:
    """Show a record as a picture with units, or as a table where it has no picture."""
    if not (isinstance(record, Recording) and not record.time_s.size):
        with suppress(OutputError):  # it has no picture
            return png_html(_png(record), type(record).__name__)
    if isinstance(record, MaterialMap):
        materials = enumerate(zip(record.materials, record.reasons, strict=True))
        rows = [(str(label), material.name, why) for label, (material, why) in materials]
        what = "part" if any(why.startswith("part ") for why in record.reasons) else "segment"
        return html_table((what, "material", "why"), rows)
    rows = [(field.name, _text(getattr(record, field.name))) for field in fields(cast(Any, record))]
    return html_table(("field", "value"), rows)


def png_html(png: bytes, what: str) -> str:
    """Embed a PNG in a page. what: its description for people who do not see it."""
    return f"<img alt='{escape(what)}' src='data:image/png;base64,{base64.b64encode(png).decode()}'>"


def _png(record: Record) -> bytes:
    from matplotlib import pyplot

    axes, file = show(record), BytesIO()
    figure = axes.get_figure(root=True)
    assert figure is not None
    try:
        figure.savefig(file, format="png", dpi=DPI)  # pyright: ignore[reportUnknownMemberType]
    finally:
        pyplot.close(figure)
    return file.getvalue()


def _text(value: Any) -> str:
    if isinstance(value, np.ndarray):
        array = cast(np.ndarray, value)
        return f"{array.dtype} {array.shape}"
    return str(value)
