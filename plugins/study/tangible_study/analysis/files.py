"""The files of an analysis: a table for programs, one for a paper, and plots."""

from collections.abc import Iterator
from math import isfinite
from pathlib import Path
from typing import Any

from tangible_core.files import sole_writer, write_text

from ..measures.rows import Result, Row, as_record
from ..trials import MISSING
from .analysing import Analysis, counts
from .plots import draw

HEADINGS = ("measure", "condition", "compared with", "value", "95 % interval", "chance", "p", "trials")


def write_results(folder: Path, analysis: Analysis) -> list[Path]:
    """Write results.tsv, results.md and a plot for each comparison, each whole or not at all; return their paths.

    Raises: OutputError if the folder cannot be written, or another analysis is writing into it.
    """
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
    study = analysis.kept.study
    parts = [f"# {study.title or study.study}", counts(analysis.kept)]
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
    shown = [row for row in result.rows if row.participant == "all"] if "all" in whom else result.rows
    yield f"| {' | '.join(HEADINGS)} |"
    yield f"|{'---|' * len(HEADINGS)}"
    for row in shown:
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
