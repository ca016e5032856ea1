"""The sheet of a run: panels for its products, and those that plugins add."""

import logging
import warnings
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from itertools import count, product
from pathlib import Path
from string import ascii_lowercase
from typing import Any

import numpy as np
from matplotlib import style
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.figure import Figure
from matplotlib.text import Text
from matplotlib.ticker import FuncFormatter, ScalarFormatter

from tangible_core.data import (
    PRODUCTS,
    DisparityMap,
    HapticSurface,
    MaterialMap,
    PartMap,
    Record,
    Relief,
    SegmentMap,
    Views,
)
from tangible_core.errors import OutputError, shown
from tangible_core.files import atomic_write
from tangible_core.plugins import Panel, hooks
from tangible_core.plugins.registry import default_registry
from tangible_core.session import Recording
from tangible_core.translation import LANGUAGES, translate
from tangible_legibility.words.languages import language_of, spoken_language

from ..description import describe
from ..panels import PANELS, draw_segments
from ..style import STYLE
from .files import describe_sheet, writer
from .layout import Box, Cell, arrange

log = logging.getLogger(__name__)

WIDTH_IN = 12.0
TITLE_IN = 0.3
HEADLINE_IN = 0.45
DPI = 150
SHAPES: dict[str, Callable[[Any], tuple[float, float]]] = {
    "views": lambda views: views.shape,
    "disparity": lambda disparity: disparity.disparity_px.shape,
    "segments": lambda segments: segments.labels.shape,
    "parts": lambda parts: parts.labels.shape,
    "relief": lambda relief: relief.extent_m[::-1],
}
"""Product -> its height and width, for products with the scene's proportions."""
PANEL_OF: Mapping[type[Record], str] = {
    Views: "views",
    **{row.record: row.panel for row in PRODUCTS.values() if row.record is not None and row.panel},
    Recording: "recording",
}
"""Class of a record that can be drawn -> the product of its panel."""
MINUS = "\u2212"  # the sign before numbers at axes
HEIGHT_IN = 3.5  # the height of the axes of a new figure, inches


def draw_sheet(
    path: Path,
    *,
    views: Views | None = None,
    truth: np.ndarray | None = None,
    disparity: DisparityMap | None = None,
    segments: SegmentMap | None = None,
    parts: PartMap | None = None,
    materials: MaterialMap | None = None,
    relief: Relief | None = None,
    surface: HapticSurface | None = None,
    recording: Recording | None = None,
    title: str = "",
    language: str = "en",
    **others: Record | None,
) -> str:
    """Draw the products of a run as .png, .svg or .pdf, and return a description in words, which is in the file too.

    truth: disparity (h, w) in px, not finite where unknown. relief: for a run without a surface. language: of the title
    and names. others: further products by name, for panels of plugins. Panels without data are left out.
    Raises: OutputError for another suffix or a file that cannot be written, PictureError for sizes that differ.
    """
    products = {
        "views": views,
        "truth": truth if disparity is not None and disparity.unit == "px" else None,
        "disparity": disparity,
        "segments": segments,
        "parts": parts,
        "materials": materials,
        "relief": relief if surface is None else surface.relief,
        "surface": surface,
        "recording": recording if recording is not None and len(recording.time_s) else None,
        **others,
    }
    run = {name: value for name, value in products.items() if value is not None}
    panels = [panel for panel in PANELS if parts is None or panel.draw is not draw_segments]
    return write_sheet(path, run, title, (*panels, *added_panels()), language)


def write_sheet(path: Path, run: Mapping[str, Any], title: str, panels: Sequence[Panel], language: str = "en") -> str:
    """Draw panels in the report's style, whole or not at all, and return their description. Raises: as `draw_sheet`."""
    write = writer(path)
    with style.context(STYLE, after_reset=True):
        figure = draw_figure(run, title, panels)
        _translate(figure, to := language_of(language))
        says = translate(describe_sheet(figure), to)
        if isinstance(surface := run.get("surface"), HapticSurface):
            says = f"{says} {describe(surface, '', spoken_language(language, log))}"
        with warnings.catch_warnings(), atomic_write(path) as file:
            # A title in a script that the font lacks is drawn as boxes; the description in the file has the title too.
            warnings.filterwarnings("ignore", r"Glyph \d+ .* missing from", UserWarning)
            write(figure, file, title, says)
    return says


def draw_figure(run: Mapping[str, Any], title: str, panels: Sequence[Panel]) -> Figure:
    """Draw the panels whose products exist, lettered in reading order. Raises: OutputError if there are none."""
    panels = [panel for panel in panels if run.keys() >= set(panel.needs)]
    if not panels:
        raise OutputError(f"{title}: there is nothing to draw; request a product that can be drawn")
    boxes, width_in, height_in = arrange(
        [
            Cell(
                panel_aspect(drawing, run),
                drawing.left_in,
                drawing.right_in,
                drawing.bottom_in,
                HEADLINE_IN,
                drawing.least_in,
            )
            for drawing in panels
        ],
        WIDTH_IN,
    )
    figure = Figure(figsize=(width_in, height_in + TITLE_IN), dpi=DPI, facecolor="white")
    figure.text(0.15 / width_in, 1 - 0.1 / (height_in + TITLE_IN), title, fontsize=13, weight="bold", va="top")
    for letter, panel, box in zip(_letters(), panels, boxes, strict=False):
        _draw_panel(figure, panel, box, run, letter)
    return figure


def _translate(figure: Figure, language: str) -> None:
    """Put headlines, captions, legends and numbers into a language; the title is the user's."""
    if language == LANGUAGES[0]:
        return
    for text in figure.findobj(Text):
        if isinstance(text, Text) and text is not figure.texts[0]:
            text.set_text(translate(text.get_text(), language))
    own = FuncFormatter(lambda value, _: translate(f"{value:g}".replace("-", MINUS), language))
    for axis in figure.findobj(Axis):
        if isinstance(axis, Axis) and isinstance(axis.get_major_formatter(), ScalarFormatter):
            axis.set_major_formatter(own)


def _letters() -> Iterator[str]:
    """Yield a, b ... z, aa, ab ..."""
    for size in count(1):
        yield from map("".join, product(ascii_lowercase, repeat=size))


def scene_aspect(run: Mapping[str, Any]) -> float:
    """Return width over height of the scene, limited to 1:4 to 6:1 so that even a narrow strip gets a panel."""
    height, width = next((SHAPES[name](run[name]) for name in SHAPES if name in run), (1.0, 1.0))
    return min(max(width / height, 0.25), 6.0)


def panel_aspect(panel: Panel, run: Mapping[str, Any]) -> float:
    """Return width over height of a panel of this run."""
    own = panel.aspect(**_panel_products(panel, run)) if callable(panel.aspect) else panel.aspect
    return own or scene_aspect(run)


def _panel_products(panel: Panel, run: Mapping[str, Any]) -> dict[str, Any]:
    return {name: run[name] for name in (*panel.needs, *panel.likes) if name in run}


def _draw_panel(figure: Figure, panel: Panel, box: Box, run: Mapping[str, Any], letter: str) -> None:
    width_in, height_in = figure.get_size_inches()
    top_in = height_in - TITLE_IN - box.top_in
    left, top = box.left_in / width_in, top_in / height_in
    place = (left, top - box.height_in / height_in, box.width_in / width_in, box.height_in / height_in)
    axes = figure.add_axes(place)
    headline = panel.draw(axes, **_panel_products(panel, run))
    line = top + 0.1 / height_in
    figure.text(left, line, letter, fontsize=11, weight="bold")
    figure.text(left + 0.18 / width_in, line, headline, fontsize=10)


def added_panels() -> Iterator[Panel]:
    """Yield the panels that hook modules add by `tangible_panels`; other answers are logged and left out."""
    for answer in hooks.tell(default_registry().plugins, "tangible_panels"):
        for panel in answer if isinstance(answer, Iterable) else [answer]:  # pyright: ignore[reportUnknownVariableType]
            if isinstance(panel, Panel):
                yield panel._replace(draw=_guard(panel.draw))
            else:
                log.warning("tangible_panels gave %s, which is not a Panel; it is left out", shown(repr(panel)))  # pyright: ignore[reportUnknownArgumentType]


def _guard(draw: Callable[..., str]) -> Callable[..., str]:
    """Return a drawing function that shows an error in place of its panel, so that the others are drawn."""

    def draw_or_fail(axes: Axes, **run: Any) -> str:
        try:
            return str(draw(axes, **run))
        except Exception as error:
            log.warning("a panel of a plugin could not be drawn", exc_info=True)
            axes.clear()
            axes.set_axis_off()
            return shown(f"Not drawn, {type(error).__name__}: {error}", 60)

    return draw_or_fail


def show(product: Record, axes: Axes | None = None, **others: Any) -> Axes:
    """Draw a product as its panel on the sheet, with units; return the axes, whose title is the panel's headline.

    axes: by default those of a new pyplot figure. others: other products that the panel can show too, by name.
    Raises: OutputError for a product that has no picture, such as materials without segments.
    """
    name = PANEL_OF.get(type(product))
    if name is None:
        names = ", ".join(record.__name__ for record in PANEL_OF)
        raise OutputError(f"a {type(product).__name__} has no picture of its own; these have one: {names}")
    run = {**others, name: product.relief if isinstance(product, HapticSurface) else product}
    panel = next(candidate for candidate in PANELS if set(candidate.needs) == {name})
    with style.context(STYLE):
        target = _new_axes(panel, run) if axes is None else axes
        target.set_title(panel.draw(target, **_panel_products(panel, run)))
    return target


def _new_axes(panel: Panel, run: Mapping[str, Any]) -> Axes:
    from matplotlib import pyplot

    width_in = HEIGHT_IN * panel_aspect(panel, run)
    size_in = width_in + panel.left_in + panel.right_in, HEIGHT_IN + panel.bottom_in + HEADLINE_IN
    figure = pyplot.figure(figsize=size_in)
    wide, high = size_in
    return figure.add_axes((panel.left_in / wide, panel.bottom_in / high, width_in / wide, HEIGHT_IN / high))
