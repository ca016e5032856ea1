"""The files of an analysis: a table for programs, one for a paper, and plots."""

from collections.abc import Iterator
from math import isfinite
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib import style
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from tangible_core.files import atomic_write, sole_writer, write_text
from tangible_report.drawing.files import writer
from tangible_report.style import INK, OKABE_ITO, STYLE

from ..measures.rows import ALL, Result, Row, as_record
from ..trials import MISSING
from .analysing import Analysis, counts, sentences

HEADINGS = ("measure", "condition", "compared with", "value", "95 % interval", "chance", "p", "trials")


def write_results(folder: Path, analysis: Analysis) -> list[Path]:
    """Write results.tsv, results.md and a plot for each comparison; return their paths. Raises: OutputError."""
    table, paper = folder / "results.tsv", folder / "results.md"
    with sole_writer(table):
        plots = [path for result in analysis.results for path in draw(folder, result)]
        write_text(table, as_tsv(analysis))
        write_text(paper, as_markdown(analysis))
    return [paper, table, *plots]


def as_tsv(analysis: Analysis) -> str:
    """Return every figure, of each participant and of all: tab-separated, missing values as BIDS has them."""
    rows = [{"comparison": result.comparison, **as_record(row)} for result in analysis.results for row in result.rows]
    lines = [list(rows[0]) if rows else [], *([_cell(value) for value in row.values()] for row in rows)]
    return "".join("\t".join(line) + "\n" for line in lines)


def as_markdown(analysis: Analysis) -> str:
    """Return what was found in sentences, with a table of the figures about all participants."""
    study = analysis.answers.study
    parts = [f"# {study.title or study.study}", counts(analysis.answers)]
    for result in analysis.results:
        parts += [f"## {result.comparison}", " ".join(analysis.sentences[result.comparison])]
        parts += ["\n".join(_table(result)), f"![{result.comparison}]({result.comparison}.png)"]
    return "\n\n".join(parts) + "\n\n" + METHODS + "\n"


METHODS = """\
Intervals hold 95 %. Proportions: exact (Clopper and Pearson 1934); of several participants, the mean over them, with an
interval that holds both the exact one and Student's. Psychometric functions: psignifit 4 (Schütt et al. 2016), a
cumulative Gaussian for choices, a Weibull function for differences, without overdispersion. d': Macmillan and Creelman
(2005), differencing rule for the odd one of three. Scales: Bradley and Terry (1952). Differences: Student's t over
participants; of one participant, from both intervals (Zou and Donner 2008). p: the probability of a result as far from
chance as this, if there were no difference."""


def _table(result: Result) -> Iterator[str]:
    whom = {row.participant for row in result.rows}
    rows = [row for row in result.rows if row.participant == "all"] if "all" in whom else result.rows
    yield f"| {' | '.join(HEADINGS)} |"
    yield f"|{'---|' * len(HEADINGS)}"
    for row in rows:
        yield f"| {' | '.join(_cells(row))} |"


def _cells(row: Row) -> tuple[str, ...]:
    value, low, high = row.estimate
    return (
        row.what.measure,
        row.what.condition,
        row.what.other,
        f"{value:.3g} {row.unit}".rstrip() if isfinite(value) else "",
        f"{low:.3g} to {high:.3g}" if row.estimate.has_interval else "",
        "" if row.chance != row.chance else f"{row.chance:.3g}",
        "" if row.p != row.p else "< .001" if row.p < 0.001 else f"{row.p:.3f}".removeprefix("0"),
        str(row.trials),
    )


def _cell(value: Any) -> str:
    if value is None or value != value:
        return MISSING
    return f"{value:.8g}" if isinstance(value, float) else str(value)


SIZE_IN = (6.4, 4.2)
MARKERS = "osD^vPX*"


def draw(folder: Path, result: Result) -> list[Path]:
    """Draw a result as PNG and SVG, with what was found as its description; return the paths. Raises: OutputError."""
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
    rows = result.of_all(result.main)
    for place, row in enumerate(rows):
        single = [
            figure.estimate.value for figure in result.rows if figure.what == row.what and figure.participant != ALL
        ]
        axes.plot(single, place + 0.18 + 0.02 * np.arange(len(single)) % 0.2, "o", color="#999999", markersize=3)
        value, low, high = row.estimate
        if row.estimate.has_interval and np.isfinite((low, high)).all():
            axes.plot([low, high], [place, place], color=INK, linewidth=1.5)
        axes.plot(value, place, "D", color=OKABE_ITO[0], markersize=6)
    if rows and rows[0].chance == rows[0].chance:
        axes.axvline(rows[0].chance, color="#888888", linewidth=0.8, linestyle=(0, (4, 2)))
    names = [" / ".join(filter(None, (row.what.condition, row.what.other))) for row in rows]
    axes.set_yticks(range(len(rows)), names)
    axes.set(ylim=(len(rows) - 0.5, -0.5), xlabel=f"{result.main} {rows[0].unit if rows else ''}".rstrip())
