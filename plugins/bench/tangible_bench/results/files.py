"""Results as files for other programs: every figure as CSV, the means as a table for LaTeX."""

import csv
import io
import math
import re
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

from tangible_core.files import write_text

from .summary import Cell, median
from .table import Results, tables

CSV, LATEX = "table.csv", "table.tex"

_LATEX = {"\\": r"\textbackslash{}", "~": r"\textasciitilde{}", "^": r"\textasciicircum{}"}


def write_tables(folder: Path, results: Results) -> tuple[Path, Path]:
    """Write both files, each whole or not at all. Raises: OutputError if the folder cannot be written."""
    write_text(folder / CSV, as_csv(results))
    write_text(folder / LATEX, as_latex(results))
    return folder / CSV, folder / LATEX


def as_csv(results: Results) -> str:
    """Return a row for each method, scene and perturbation: medians over the rounds, unrounded; empty if unknown."""
    measures = list(results.task.measures)
    times = ("seconds", "first_seconds", "ratio", "peak_memory_bytes")
    rows = ((*cell.key, *_figures(cell, measures), cell.error or "") for cell in results.cells.values())
    return csv_text(("method", "scene", "perturb", *times, *measures, "error"), rows)


def _figures(cell: Cell, measures: list[str]) -> Iterator[str]:
    times = (median(values) for values in (cell.seconds, cell.first_seconds, cell.ratios, cell.memory_bytes))
    for value in (*times, *(cell.measures.get(name, math.nan) for name in measures)):
        yield exact_text(value)


def as_latex(results: Results) -> str:
    r"""Return the means over the scenes, as the terminal shows them, for `\usepackage{booktabs}` and `\input`."""
    table = tables(results)[0]
    rows = ([escape(cell) for cell in row] for row in table.rows)
    return latex_text(f"{table.title}; * is Pareto-optimal", 2, table.headings, rows)


def exact_text(value: float) -> str:
    """Return a figure with all its digits; an empty text if it is not finite."""
    return repr(float(value)) if math.isfinite(value) else ""


def csv_text(headings: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Return a table as CSV."""
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows((headings, *rows))
    return text.getvalue()


def latex_text(title: str, words: int, headings: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Return a table for LaTeX's booktabs. words: the number of left columns that hold text. rows: LaTeX already."""
    lines = [
        f"% {title}. Needs \\usepackage{{booktabs}}.",
        rf"\begin{{tabular}}{{{'l' * words}{'r' * (len(headings) - words)}}}",
        r"\toprule",
        " & ".join(map(escape, headings)) + r" \\",
        r"\midrule",
        *(" & ".join(row) + r" \\" for row in rows),
        r"\bottomrule",
        r"\end{tabular}",
    ]
    return "\n".join(lines) + "\n"


def escape(text: str) -> str:
    r"""Return LaTeX that prints a text as it is.

    >>> escape("bad2 %"), escape("a_b & c")
    ('bad2 \\%', 'a\\_b \\& c')
    """
    return re.sub(r"[\\~^&%$#_{}]", lambda match: _LATEX.get(match[0], f"\\{match[0]}"), text)
