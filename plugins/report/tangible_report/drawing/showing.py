"""The picture of one product, as on the sheet."""
# pyright: reportUnknownMemberType=false
# (matplotlib leaves its keywords without types)

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from tangible_core.data import HapticSurface, Record, Views
from tangible_core.data.products import PRODUCTS
from tangible_core.errors import OutputError
from tangible_core.session import Recording

if TYPE_CHECKING:
    from collections.abc import Mapping

    from matplotlib.axes import Axes

    from ..panels import Panel

PANEL_OF: Mapping[type[Record], str] = {
    Views: "views",
    **{row.record: row.panel for row in PRODUCTS.values() if row.record is not None and row.panel},
    Recording: "recording",
}
"""Class of a record that can be drawn -> the product of its panel."""
HEIGHT_IN = 3.5
"""The height of the axes of a new figure, inches."""


def show(product: Record, axes: Axes | None = None, **others: Any) -> Axes:
    """Draw a product as its panel on the sheet, with units; return the axes, whose title is the panel's headline.

    axes: the axes to draw into; by default, those of a new pyplot figure with the panel's proportions.
    others: other products that the panel can show too, by name: `views` and `materials` with segments, `views` and
    `surface` with parts, `relief` with a recording.
    Raises: OutputError for a product that has no picture, such as materials without segments.
    """
    from matplotlib import style

    from ..panels import PANELS
    from ..style import STYLE

    name = PANEL_OF.get(type(product))
    if name is None:
        known = ", ".join(each.__name__ for each in PANEL_OF)
        raise OutputError(f"a {type(product).__name__} has no picture of its own; these have one: {known}")
    run = {**others, name: product.relief if isinstance(product, HapticSurface) else product}
    panel = next(each for each in PANELS if set(each.needs) == {name})
    with style.context(STYLE):
        drawn = _new_axes(panel, run) if axes is None else axes
        drawn.set_title(panel.draw(drawn, **{key: run[key] for key in (*panel.needs, *panel.likes) if key in run}))
    return drawn


def _new_axes(panel: Panel, run: Mapping[str, Any]) -> Axes:
    from matplotlib import pyplot

    from .sheet import HEADLINE_IN, panel_aspect

    width_in = HEIGHT_IN * panel_aspect(panel, run)
    size_in = width_in + panel.left_in + panel.right_in, HEIGHT_IN + panel.bottom_in + HEADLINE_IN
    figure = pyplot.figure(figsize=size_in)
    wide, high = size_in
    return figure.add_axes((panel.left_in / wide, panel.bottom_in / high, width_in / wide, HEIGHT_IN / high))
