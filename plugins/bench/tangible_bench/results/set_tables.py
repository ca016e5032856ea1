"""The tables that papers print of a benchmark: its own columns, a row for each method, for LaTeX and as CSV."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

from tangible_core.files import write_text

from ..config.reading import NONE
from ..datasets import SETS
from .files import csv_text, escape, exact_text, latex_text
from .summary import Cell
from .table import Results, Table


class Column(NamedTuple):
    """A measure in a benchmark's table."""

    heading: str
    measure: str
    digits: int = 2
    weight: str = ""  # the measure by which a pair is weighted, a number of pixels; empty for equal weights


_FULL = (
    *(Column(f"bad {bound} noc", f"bad{bound}_full_noc") for bound in ("0.5", "1", "2", "4")),
    *(Column(f"{name} noc", f"{measure}_full_noc") for name, measure in (("avgerr", "average_px"), ("rms", "rms_px"))),
    *(Column(f"A{share} noc", f"a{share}_px_full_noc") for share in (50, 90, 95, 99)),
    Column("invalid noc", "invalid_noc"), Column("bad 2 all", "bad2_full"), Column("avgerr all", "average_px_full"),
)  # fmt: skip
_OWN = tuple(column._replace(measure=column.measure.replace("_full", "")) for column in _FULL)
_2015 = tuple(
    Column(f"D1-{part} {over}", f"d1{name}{end}", weight=f"pixels{name}{end}")
    for over, end in (("noc", "_noc"), ("all", ""))
    for part, name in (("bg", "_bg"), ("fg", "_fg"), ("all", ""))
)
_2012 = (
    *(Column(f"Out-Noc {bound} px", f"bad{bound}_noc") for bound in (2, 3, 4)),
    *(Column(f"Out-All {bound} px", f"bad{bound}") for bound in (2, 3, 4)),
    Column("Avg-Noc", "average_px_noc"), Column("Avg-All", "average_px"), Column("Density", "density"),
)  # fmt: skip

# Name of a set -> its columns; methods are ranked by the first, unless RANKED names another.
COLUMNS: Mapping[str, Sequence[Column]] = {
    **dict.fromkeys(("middlebury-2005", "middlebury-2006"), _FULL),
    **dict.fromkeys(("middlebury-2014", "middlebury-2021", "middlebury-eval3", "booster"), _FULL),
    **dict.fromkeys(("middlebury-2001", "middlebury-2003", "eth3d", "sintel"), _OWN),
    "kitti-2012": _2012,
    "kitti-2015": (*_2015, Column("Density", "density", weight="pixels")),
}
# Measures that rank methods on the benchmark's own page, where these are not bad 2 noc.
RANKED = {"kitti-2015": "d1", "kitti-2012": "bad3_noc", "eth3d": "bad1_noc"}


@dataclass(frozen=True)
class SetTable:
    """A benchmark's table: its methods from the best to the worst."""

    label: str  # the set with its size, as in names of scenes
    scenes: int
    columns: tuple[Column, ...]
    # Method -> a value for each column; NaN where it lacks a pair that another one has.
    rows: Mapping[str, tuple[float, ...]]

    @property
    def title(self) -> str:
        """The name of the set, its size and the number of pairs."""
        name, *marks = self.label.split("@")
        return " ".join((SETS[name].title, *marks)) + f", {self.scenes} pair{'s' if self.scenes > 1 else ''}"

    @property
    def best(self) -> tuple[float, ...]:
        """The best value of each column."""
        values = zip(*self.rows.values(), strict=True)
        best = (max if column.measure == "density" else min for column in self.columns)
        return tuple(
            pick((value for value in column if not math.isnan(value)), default=math.nan)
            for pick, column in zip(best, values, strict=True)
        )


def set_tables(results: Results) -> list[SetTable]:
    """Return a table for each standard set among the undamaged scenes, if any of its pairs has truth."""
    scenes: dict[str, list[str]] = {}
    for scene in results.scenes:
        label, inside, _ = scene.partition("/")
        if inside and label.partition("@")[0] in SETS:
            scenes.setdefault(label, []).append(scene)
    if results.task.kind != "depth":
        return []
    return [table for label, of_set in scenes.items() if (table := _table(results, label, of_set)).rows]


def _table(results: Results, label: str, scenes: Sequence[str]) -> SetTable:
    name = label.partition("@")[0]
    methods = dict.fromkeys(cell.method for cell in results.cells.values())
    cells = {method: [results.cells.get((method, scene, NONE)) for scene in scenes] for method in methods}
    rows = {method: tuple(_mean(own_cells, column) for column in COLUMNS[name]) for method, own_cells in cells.items()}
    rows = {method: values for method, values in rows.items() if not all(map(math.isnan, values))}
    first = RANKED.get(name, "bad2_full_noc" if COLUMNS[name] is _FULL else "bad2_noc")
    order = next(index for index, column in enumerate(COLUMNS[name]) if column.measure == first)
    order_of_methods = sorted(rows, key=lambda method: (math.isnan(rows[method][order]), rows[method][order]))
    return SetTable(label, len(scenes), tuple(COLUMNS[name]), {method: rows[method] for method in order_of_methods})


def _mean(cells: Sequence[Cell | None], column: Column) -> float:
    """Return the mean over the pairs that have the measure, such as a foreground; NaN if a pair has no result."""
    if any(cell is None or cell.error is not None or not cell.seconds for cell in cells):
        return math.nan
    measures = [cell.measures for cell in cells if cell is not None]
    pairs = [(measure.get(column.measure, math.nan), measure.get(column.weight, 1.0)) for measure in measures]
    weights = [(value, weight) for value, weight in pairs if not math.isnan(value)]
    whole = sum(weight for _, weight in weights)
    return sum(value * weight for value, weight in weights) / whole if whole else math.nan


def as_table(table: SetTable) -> Table:
    """Return the table as the terminal prints it."""
    rows = tuple((method, *_texts(table, values)) for method, values in table.rows.items())
    return Table(table.title, _headings(table), rows)


def as_csv(table: SetTable) -> str:
    """Return the table with unrounded figures; empty where there is none."""
    rows = ((method, *map(exact_text, values)) for method, values in table.rows.items())
    return csv_text(_headings(table), rows)


def as_latex(table: SetTable) -> str:
    r"""Return the table for `\usepackage{booktabs}` and `\input`; the best figure of each column is bold."""
    rows = ((escape(method), *_bold(table, values)) for method, values in table.rows.items())
    return latex_text(table.title, 1, _headings(table), rows)


def write_set_tables(folder: Path, results: Results) -> tuple[Path, ...]:
    """Write both files of each set, whole or not at all. Raises: OutputError if the folder cannot be written."""
    files: list[Path] = []
    for table in set_tables(results):
        for end, text in ((".csv", as_csv(table)), (".tex", as_latex(table))):
            files.append(folder / f"{table.label}{end}")
            write_text(files[-1], text)
    return tuple(files)


def _headings(table: SetTable) -> tuple[str, ...]:
    return ("method", *(column.heading for column in table.columns))


def _texts(table: SetTable, values: Sequence[float]) -> Iterator[str]:
    for column, value in zip(table.columns, values, strict=True):
        yield "-" if math.isnan(value) else f"{value:.{column.digits}f}"


def _bold(table: SetTable, values: Sequence[float]) -> Iterator[str]:
    for text, value, best in zip(_texts(table, values), values, table.best, strict=True):
        yield rf"\textbf{{{text}}}" if value == best else text
