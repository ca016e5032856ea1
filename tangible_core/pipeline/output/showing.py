"""One product as a picture, drawn by the exporter `sheet`, which is found like any other plugin."""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING, Any, cast

from ...errors import BrokenMethod
from ...plugins.interfaces import Drawing, Exporter
from ...plugins.notes import note
from ...plugins.registry import Registry, default_registry

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from ...data import Record

log = logging.getLogger(__name__)

SHEET = "sheet"
"""The exporter that draws runs and products."""


def can_draw(registry: Registry) -> bool:
    """Tell whether the exporter that draws is installed; without it, a run has no sheet, and a note says so."""
    if SHEET in registry.names("export"):
        return True
    note(log, f"no sheet is drawn: no exporter named {SHEET!r} is installed")
    return False


def drawing(**options: Any) -> Drawing:
    """Load the exporter that draws. Raises: UnknownMethod, BrokenMethod."""
    sheet: type[Exporter] = cast("type[Exporter]", default_registry().load("export", SHEET))
    if not issubclass(sheet, Drawing):
        raise BrokenMethod(f"export method {SHEET!r} is not a Drawing; rename it, for runs are drawn by this one")
    return sheet(**options)


def show(product: Record, axes: Axes | None = None, **others: Any) -> Axes:
    """Draw a product as its panel on the sheet of a run, with units; returns the axes, whose title says what it is.

    axes: where to draw; a new pyplot figure of the panel's own proportions where it is None.
    others: products that the panel can show with it, by name: `views` and `materials` with segments, `views` and
    `surface` with parts, `relief` with a recording.
    Raises: OutputError for a product that has no picture, such as materials without segments.
    """
    return drawing().show(product, axes, **others)
