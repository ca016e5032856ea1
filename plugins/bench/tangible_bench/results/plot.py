"""Run time against error, one panel a measure, with the Pareto front; and a curve, if the kind of method has one."""
# matplotlib keywords have no types.
# pyright: reportUnknownMemberType=false

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tangible_core.files.writing import atomic_write

from .labels import place_labels
from .table import Results

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from ..tasks.task import Curve
    from .summary import Line

MARKERS = "osD^vPX*"
"""Shapes beside colours: eight of each tell 64 methods apart, in grey print too."""
EDGE: dict[str, Any] = {"markeredgecolor": "#222222", "markeredgewidth": 0.5}
"""Pale colours need it on white."""
PANEL_IN = (6.4, 4.8)
DPI = 150


def draw_plot(path: Path, results: Results) -> bool:
    """Draw the means over all scenes as a PNG, whole or not at all; False, and nothing, if no method has a mean.

    A measure that no method has gets no panel, nor does a curve.
    Raises: OutputError if the place cannot be written.
    """
    from matplotlib import style
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    from tangible_report.style import STYLE

    found = [line for line in results.means() if math.isfinite(line.seconds)]
    measures = [measure for measure in results.task.plotted if results.on_front(found, measure)]
    if not measures:
        return False
    curve = results.task.curve
    curved = [line for line in found if curve and all(map(math.isfinite, _values(line, curve.points)))]
    count = len(measures) + bool(curved)
    with style.context(STYLE):
        figure = Figure(figsize=(PANEL_IN[0] * count, PANEL_IN[1]), dpi=DPI, layout="constrained")
        canvas = FigureCanvasAgg(figure)
        panels: list[Any] = list(figure.subplots(1, count, squeeze=False)[0])
        for axes, measure in zip(panels, measures, strict=False):
            _panel(axes, results, found, measure)
        if curve and curved:
            _curve_panel(panels[-1], found, curved, curve)
        figure.suptitle(_title(results), fontsize=10)
        canvas.draw()  # labels need to know where the points came to lie
        figure.set_layout_engine("none")
        for axes, measure in zip(panels, measures, strict=False):
            place_labels(
                axes,
                [(each.method, *_point(results, each, measure)) for each in found],
                _front(results, found, measure),
            )
        with atomic_write(path) as file:
            canvas.print_png(file)
    return True


def _panel(axes: Axes, results: Results, found: list[Line], measure: str) -> None:
    from matplotlib.ticker import LogLocator, NullFormatter

    from tangible_report.style import INK

    for index, line in _in_order(found):
        x, y = _point(results, line, measure)
        axes.plot(x, y, color=_colour(index), marker=_marker(index), markersize=7, zorder=3, **EDGE)
    best = _front(results, found, measure)
    axes.step(*zip(*best, strict=True), where="post", color=INK, linewidth=1, linestyle=(0, (4, 2)), zorder=2)
    axes.set_xscale("log")
    axes.margins(0.14)
    axes.xaxis.set_major_locator(LogLocator(subs=(1, 2, 5)))
    axes.xaxis.set_major_formatter("{x:g}")
    axes.xaxis.set_minor_formatter(NullFormatter())
    axes.set(xlabel=f"time, {results.task.clock.unit}", ylabel=results.heading(measure))
    _rule(axes)


def _curve_panel(axes: Axes, found: list[Line], curved: list[Line], curve: Curve) -> None:
    """Each method as it is, and dotted as it would be at best; colours and shapes are those of the other panels."""
    for index, line in _in_order(found):
        if line in curved:
            colour = _colour(index)
            axes.plot(list(curve.ideal), _values(line, curve.ideal), color=colour, linewidth=1, linestyle=":")
            at = list(curve.points), _values(line, curve.points)
            axes.plot(*at, color=colour, marker=_marker(index), markersize=5, label=line.method, **EDGE)
    axes.set(xlabel=curve.over, ylabel=curve.title)
    axes.legend(title="dotted: the best there could be", title_fontsize=8)
    _rule(axes)


def _rule(axes: Axes) -> None:
    """Pale lines behind what is drawn."""
    axes.grid(color="#dddddd", linewidth=0.5)
    axes.set_axisbelow(True)


def _in_order(found: list[Line]) -> Iterator[tuple[int, Line]]:
    """By name, so that a method has one colour and shape in every panel."""
    return enumerate(sorted(found, key=lambda line: line.method))


def _values(line: Line, points: Mapping[int, str]) -> list[float]:
    return [line.measures.get(name, math.nan) for name in points.values()]


def _front(results: Results, found: list[Line], measure: str) -> list[tuple[float, float]]:
    return [_point(results, found[index], measure) for index in results.on_front(found, measure)]


def _point(results: Results, line: Line, measure: str) -> tuple[float, float]:
    return results.task.clock.per_second * line.seconds, line.measures.get(measure, math.nan)


def _colour(index: int) -> str:
    from tangible_report.style import OKABE_ITO

    return OKABE_ITO[index % len(OKABE_ITO)]


def _marker(index: int) -> str:
    return MARKERS[index // 8 % 8]


def _title(results: Results) -> str:
    count = len(results.scenes)
    scenes = results.scenes[0] if count == 1 else f"mean of {count} scenes"
    return f"{results.task.kind}: {scenes}; dashed: Pareto front"
