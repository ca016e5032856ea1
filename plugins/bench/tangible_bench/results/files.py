"""Results as files for other programs: every figure as CSV, the means as a table for LaTeX."""

import csv
import io
import math
import re
from collections.abc import Iterable, Iterator
from pathlib import Path

from tangible_core.files.writing import write_text

from .summary import Cell, median
from .table import Results, tables

CSV, LATEX = "table.csv", "table.tex"

_LATEX = {"\\": r"\textbackslash{}", "~": r"\textasciitilde{}", "^": r"\textasciicircum{}"}


def write_tables(folder: Path, results: Results) -> tuple[Path, Path]:
    """Both files, each whole or not at all. Raises: OutputError if the folder cannot be written."""
    write_text(folder / CSV, as_csv(results))
    write_text(folder / LATEX, as_latex(results))
    return folder / CSV, folder / LATEX


def as_csv(results: Results) -> str:
    """A line for each method, scene and perturbation: medians over the rounds, unrounded; empty where there is none."""
    measures = list(results.task.measures)
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    times = ("seconds", "first_seconds", "ratio", "peak_memory_bytes")
    writer.writerow(("method", "scene", "perturb", *times, *measures, "error"))
    for cell in results.cells.values():
        writer.writerow((*cell.key, *_figures(cell, measures), cell.error or ""))
    return text.getvalue()


def _figures(cell: Cell, measures: list[str]) -> Iterator[str]:
    times = (median(values) for values in (cell.seconds, cell.first_seconds, cell.ratios, cell.memory_bytes))
    for value in (*times, *(cell.measures.get(name, math.nan) for name in measures)):
        yield repr(float(value)) if math.isfinite(value) else ""


def as_latex(results: Results) -> str:
    r"""The means over the scenes, as the terminal shows them, for `\usepackage{booktabs}` and `\input`."""
    table = tables(results)[0]
    lines = [
        f"% {table.title}; * is Pareto-optimal. Needs \\usepackage{{booktabs}}.",
        rf"\begin{{tabular}}{{ll{'r' * (len(table.headings) - 2)}}}",
        r"\toprule",
        *_rows([table.headings]),
        r"\midrule",
        *_rows(table.rows),
        r"\bottomrule",
        r"\end{tabular}",
    ]
    return "\n".join(lines) + "\n"


def _rows(rows: Iterable[tuple[str, ...]]) -> list[str]:
    return [" & ".join(escaped(cell) for cell in row) + r" \\" for row in rows]


def escaped(text: str) -> str:
    r"""A text that LaTeX prints as it stands.

    >>> escaped("bad2 %"), escaped("a_b & c")
    ('bad2 \\%', 'a\\_b \\& c')
    """
    return re.sub(r"[\\~^&%$#_{}]", lambda found: _LATEX.get(found[0], f"\\{found[0]}"), text)
