"""Plots of a result: functions over levels, or figures with their intervals; each participant is a small point."""
# matplotlib keywords have no types.

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from tangible_core.files import atomic_write

from ..measures.rows import ALL, Result
from .analysing import sentences

if TYPE_CHECKING:
    from matplotlib.axes import Axes

SIZE_IN = (6.4, 4.2)
MARKERS = "osD^vPX*"


def draw(folder: Path, result: Result) -> list[Path]:
    """Draw a result as PNG and SVG, with what was found as its description; return the paths. Raises: OutputError."""
    from matplotlib import style
    from matplotlib.figure import Figure

    from tangible_report.drawing.files import writer
    from tangible_report.style import STYLE

    paths = [folder / f"{result.comparison}{suffix}" for suffix in (".png", ".svg")]
    with style.context(STYLE):
        figure = Figure(figsize=SIZE_IN, dpi=150, layout="constrained")
        axes = figure.subplots()
        if result.curves:
            _draw_curves(axes, result)
        else:
            _draw_figures(axes, result)
        axes.set_title(f"{result.comparison}: {result.main}", loc="left", fontsize=10)
        axes.grid(color="#dddddd", linewidth=0.5)
        axes.set_axisbelow(True)
        for path in paths:
            with atomic_write(path) as file:
                writer(path)(figure, file, result.comparison, " ".join(sentences(result)))
    return paths


def _draw_curves(axes: Axes, result: Result) -> None:
    """Draw the share of answers at each level and the fitted functions; with several participants, thin and paler."""
    from tangible_report.style import OKABE_ITO

    conditions = list(dict.fromkeys(key.partition("/")[2] for key in result.curves))
    alone = len(result.participants) == 1
    for key, curve in result.curves.items():
        blocks, index = result.blocks[key], conditions.index(key.partition("/")[2])
        colour, marker = OKABE_ITO[index % len(OKABE_ITO)], MARKERS[index % len(MARKERS)]
        levels = np.linspace(blocks.levels.min(), blocks.levels.max(), 200)
        axes.plot(levels, curve.at(levels), color=colour, linewidth=1.5 if alone else 0.7, alpha=1 if alone else 0.6)
        area = 4 + 30 * blocks.trials / blocks.trials.max()
        axes.scatter(blocks.levels, blocks.counts / blocks.trials, area, color=colour, marker=marker, alpha=0.7)
    for index, condition in enumerate(conditions):
        axes.plot(
            [], [], color=OKABE_ITO[index % len(OKABE_ITO)], marker=MARKERS[index % len(MARKERS)], label=condition
        )
    chance = next(iter(result.curves.values())).chance
    axes.axhline(chance or 0.5, color="#888888", linewidth=0.8, linestyle=(0, (4, 2)))
    unit = next((row.unit for row in result.rows if row.what.measure == result.main), "")
    axes.set(
        xlabel=f"{'difference' if chance else 'level'}, {unit}".rstrip(", "),
        ylabel="share of right answers" if chance else f"share of answers '{result.question}'",
        ylim=(-0.03, 1.03),
    )
    axes.legend()


def _draw_figures(axes: Axes, result: Result) -> None:
    """Draw each figure with its interval, and the figures of single participants next to it."""
    from tangible_report.style import INK, OKABE_ITO

    shown = result.of_all(result.main)
    for place, row in enumerate(shown):
        single = [each.estimate.value for each in result.rows if each.what == row.what and each.participant != ALL]
        axes.plot(single, place + 0.18 + 0.02 * np.arange(len(single)) % 0.2, "o", color="#999999", markersize=3)
        value, low, high = row.estimate
        if row.estimate.has_interval and np.isfinite((low, high)).all():
            axes.plot([low, high], [place, place], color=INK, linewidth=1.5)
        axes.plot(value, place, "D", color=OKABE_ITO[0], markersize=6)
    if shown and shown[0].chance == shown[0].chance:
        axes.axvline(shown[0].chance, color="#888888", linewidth=0.8, linestyle=(0, (4, 2)))
    names = [" / ".join(filter(None, (row.what.condition, row.what.other))) for row in shown]
    axes.set_yticks(range(len(shown)), names)
    axes.set(ylim=(len(shown) - 0.5, -0.5), xlabel=f"{result.main} {shown[0].unit if shown else ''}".rstrip())
