"""The plot: error over run time, a panel for each measure, with the Pareto front; and a curve, if the task has one."""
# matplotlib keywords have no types.

import math
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from matplotlib import style
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullFormatter

from tangible_core.files import atomic_write
from tangible_report.style import INK, OKABE_ITO, STYLE

from ..tasks.task import Curve
from .summary import Line
from .table import Results

# Marker shapes. Eight shapes times eight colours tell 64 methods apart, even in grey print.
MARKERS = "osD^vPX*"
EDGE: dict[str, Any] = {"markeredgecolor": "#222222", "markeredgewidth": 0.5}
"""The outline of markers, without which pale colours are lost on white."""
PANEL_IN = (6.4, 4.8)  # width and height of a panel, inches
DPI = 150


def draw_plot(path: Path, results: Results) -> bool:
    """Draw the means over all scenes as a PNG; return False if no method has a mean. Raises: OutputError."""
    with_time = [line for line in results.means() if math.isfinite(line.seconds)]
    measures = [measure for measure in results.task.plot_measures if results.on_front(with_time, measure)]
    if not measures:
        return False
    curve = results.task.curve
    with_curve = [line for line in with_time if curve and all(map(math.isfinite, _values(line, curve.points)))]
    count = len(measures) + bool(with_curve)
    with style.context(STYLE):
        figure = Figure(figsize=(PANEL_IN[0] * count, PANEL_IN[1]), dpi=DPI, layout="constrained")
        panels: list[Any] = list(figure.subplots(1, count, squeeze=False)[0])
        for axes, measure in zip(panels, measures, strict=False):
            _draw_panel(axes, results, with_time, measure)
        if curve and with_curve:
            _draw_curve(panels[-1], with_time, with_curve, curve)
        figure.suptitle(_title(results), fontsize=10)
        figure.legend(*panels[0].get_legend_handles_labels(), loc="outside right upper")
        with atomic_write(path) as file:
            FigureCanvasAgg(figure).print_png(file)
    return True


def _draw_panel(axes: Axes, results: Results, with_time: list[Line], measure: str) -> None:
    for index, line in _by_name(with_time):
        x, y = _point(results, line, measure)
        axes.plot(x, y, markersize=7, zorder=3, linestyle="", label=line.method, **_look(index))
    best = _front(results, with_time, measure)
    axes.step(*zip(*best, strict=True), where="post", color=INK, linewidth=1, linestyle=(0, (4, 2)), zorder=2)
    axes.set_xscale("log")
    axes.margins(0.14)
    axes.xaxis.set_major_locator(LogLocator(subs=(1, 2, 5)))
    axes.xaxis.set_major_formatter("{x:g}")
    axes.xaxis.set_minor_formatter(NullFormatter())
    axes.set(xlabel=f"time, {results.task.clock.unit}", ylabel=results.heading(measure))
    _draw_grid(axes)


def _draw_curve(axes: Axes, with_time: list[Line], with_curve: list[Line], curve: Curve) -> None:
    """Draw each method's curve, and dotted its ideal one; with the colours and shapes of the other panels."""
    for index, line in _by_name(with_time):
        if line in with_curve:
            look = _look(index)
            ideal = list(curve.ideal), _values(line, curve.ideal)
            axes.plot(*ideal, color=look["color"], linewidth=1, linestyle=":")
            at = list(curve.points), _values(line, curve.points)
            axes.plot(*at, markersize=5, **look)
    axes.set(xlabel=curve.over, ylabel=curve.title)
    axes.set_title("dotted: the best there could be", fontsize=8)
    _draw_grid(axes)


def _draw_grid(axes: Axes) -> None:
    axes.grid(color="#dddddd", linewidth=0.5)
    axes.set_axisbelow(True)


def _by_name(lines: list[Line]) -> Iterator[tuple[int, Line]]:
    """Return numbered lines in the order of names, so that a method has the same colour and shape in every panel."""
    return enumerate(sorted(lines, key=lambda line: line.method))


def _values(line: Line, points: Mapping[int, str]) -> list[float]:
    return [line.measures.get(name, math.nan) for name in points.values()]


def _front(results: Results, with_time: list[Line], measure: str) -> list[tuple[float, float]]:
    return [_point(results, with_time[index], measure) for index in results.on_front(with_time, measure)]


def _point(results: Results, line: Line, measure: str) -> tuple[float, float]:
    return results.task.clock.per_second * line.seconds, line.measures.get(measure, math.nan)


def _look(index: int) -> dict[str, Any]:
    return {"color": OKABE_ITO[index % len(OKABE_ITO)], "marker": MARKERS[index // 8 % 8], **EDGE}


def _title(results: Results) -> str:
    count = len(results.scenes)
    scenes = results.scenes[0] if count == 1 else f"mean of {count} scenes"
    return f"{results.task.kind}: {scenes}; dashed: Pareto front"
