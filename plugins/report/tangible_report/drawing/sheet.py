"""One sheet of pictures that shows a run."""
# pyright: reportUnknownMemberType=false
# (matplotlib leaves its keywords without types)

from __future__ import annotations

import logging
import warnings
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from itertools import count, product
from pathlib import Path
from string import ascii_lowercase
from typing import TYPE_CHECKING, Any

import numpy as np
from tangible_core.plugins.panel import Panel

from tangible_core.data import DisparityMap, HapticSurface, MaterialMap, PartMap, Record, Relief, SegmentMap, Views
from tangible_core.errors import OutputError, shown
from tangible_core.files.writing import atomic_write
from tangible_core.parts.words.languages import spoken_language
from tangible_core.plugins import hooks
from tangible_core.plugins.registry import default_registry

from ..description import describe
from .files import described, writer
from .layout import Cell, arrange

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from tangible_core.plugins.hooks import Panel
    from tangible_core.session import Recording

    from .layout import Box

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
"""Height and width of what has the scene's shape."""


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
    """Draw what a run has as .png, .svg or .pdf, whole or not at all; panels without data are left out.

    Returns: what is on it in words, which is in the file too.

    truth: disparity (h, w) in px, not finite where unknown; shown as an error where the disparity is in px.
    parts: drawn in place of the segments that they are of.
    relief: where there is no surface yet; a surface brings its own.
    recording: shown together with the relief that it was felt on. language: of the title and of names, as a tag; the
    surface is described in it where there are words. others: further products by name, for panels of plugins.
    Raises: OutputError for another suffix or a place that cannot be written, PictureError if truth and disparity
    differ in size.
    """
    from ..panels import PANELS, draw_segments

    given = {
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
    run = {name: value for name, value in given.items() if value is not None}
    panels = [panel for panel in PANELS if parts is None or panel.draw is not draw_segments]
    return write_sheet(path, run, title, (*panels, *added_panels()), language)


def write_sheet(path: Path, run: Mapping[str, Any], title: str, panels: Sequence[Panel], language: str = "en") -> str:
    """Draw what is given in the report's style, whole or not at all, and say what it is. Raises: as `draw_sheet`."""
    from matplotlib import style

    from ..style import STYLE

    write = writer(path)
    with style.context(STYLE, after_reset=True):
        figure = draw_figure(run, title, panels)
        says = described(figure)
        if isinstance(surface := run.get("surface"), HapticSurface):
            says = f"{says} {describe(surface, '', spoken_language(language, log))}"
        with warnings.catch_warnings(), atomic_write(path) as file:
            # A title in a script that the font lacks is drawn as boxes; the description in the file says it.
            warnings.filterwarnings("ignore", r"Glyph \d+ .* missing from", UserWarning)
            write(figure, file, title, says)
    return says


def draw_figure(run: Mapping[str, Any], title: str, panels: Sequence[Panel]) -> Figure:
    """The sheet of those panels whose products are there, lettered in reading order."""
    from matplotlib.figure import Figure

    panels = [panel for panel in panels if run.keys() >= set(panel.needs)]
    if not panels:
        raise OutputError(f"{title}: there is nothing to draw; ask for a product that can be drawn")
    boxes, width_in, height_in = arrange([_cell(panel, run) for panel in panels], WIDTH_IN)
    figure = Figure(figsize=(width_in, height_in + TITLE_IN), dpi=DPI, facecolor="white")
    figure.text(0.15 / width_in, 1 - 0.1 / (height_in + TITLE_IN), title, fontsize=13, weight="bold", va="top")
    for letter, panel, box in zip(_letters(), panels, boxes, strict=False):
        _draw_panel(figure, panel, box, run, letter)
    return figure


def _letters() -> Iterator[str]:
    """a, b ... z, aa, ab ..."""
    for size in count(1):
        yield from map("".join, product(ascii_lowercase, repeat=size))


def scene_aspect(run: Mapping[str, Any]) -> float:
    """Width over height of what the run shows, kept between 1:4 and 6:1 so that a strip still has a panel."""
    height, width = next((SHAPES[name](run[name]) for name in SHAPES if name in run), (1.0, 1.0))
    return min(max(width / height, 0.25), 6.0)


def panel_aspect(panel: Panel, run: Mapping[str, Any]) -> float:
    """Width over height of this panel of a run."""
    own = panel.aspect(**_shown(panel, run)) if callable(panel.aspect) else panel.aspect
    return own or scene_aspect(run)


def _cell(panel: Panel, run: Mapping[str, Any]) -> Cell:
    room_in = panel.left_in, panel.right_in, panel.bottom_in, HEADLINE_IN
    return Cell(panel_aspect(panel, run), *room_in, panel.least_in, panel.least_aspect)


def _shown(panel: Panel, run: Mapping[str, Any]) -> dict[str, Any]:
    return {name: run[name] for name in (*panel.needs, *panel.likes) if name in run}


def _draw_panel(figure: Figure, panel: Panel, box: Box, run: Mapping[str, Any], letter: str) -> None:
    width_in, height_in = figure.get_size_inches()
    top_in = height_in - TITLE_IN - box.top_in
    left, top = box.left_in / width_in, top_in / height_in
    place = (left, top - box.height_in / height_in, box.width_in / width_in, box.height_in / height_in)
    axes = figure.add_axes(place)
    headline = panel.draw(axes, **_shown(panel, run))
    line = top + 0.1 / height_in
    figure.text(left, line, letter, fontsize=11, weight="bold")
    figure.text(left + 0.18 / width_in, line, headline, fontsize=10)


def added_panels() -> Iterator[Panel]:
    """What hook modules add by `tangible_panels`; what is no panel is logged and left out."""
    for answer in hooks.tell(default_registry().plugins, "tangible_panels"):
        for panel in answer if isinstance(answer, Iterable) else [answer]:  # pyright: ignore[reportUnknownVariableType]
            if isinstance(panel, Panel):
                yield panel._replace(draw=_guarded(panel.draw))
            else:
                log.warning("tangible_panels gave %s, which is no Panel; it is left out", shown(repr(panel)))  # pyright: ignore[reportUnknownArgumentType]


def _guarded(draw: Callable[..., str]) -> Callable[..., str]:
    """A panel that fails says so in its place: the others are worth drawing."""

    def guarded(axes: Axes, **run: Any) -> str:
        try:
            return str(draw(axes, **run))
        except Exception as error:
            log.warning("a panel of a plugin could not be drawn", exc_info=True)
            axes.clear()
            axes.set_axis_off()
            return shown(f"Not drawn, {type(error).__name__}: {error}", 60)

    return guarded
