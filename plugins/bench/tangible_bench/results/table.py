"""Results as tables: headings and rows of text, for whoever prints them."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from ..config.reading import NONE
from ..tasks.task import Task
from .pareto import front
from .summary import Cell, Line, lines

FRONT = "*"
"""Marks a method that no other one beats in time and error at once."""


@dataclass(frozen=True)
class Results:
    """Everything that was found out, ready to be shown."""

    task: Task
    cells: dict[tuple[str, str, str], Cell]
    baseline: str | None

    @property
    def scenes(self) -> list[str]:
        """Names, in order."""
        return list(dict.fromkeys(cell.scene for cell in self.cells.values()))

    @property
    def perturbs(self) -> list[str]:
        """Names, in order, the undamaged scenes first if there are any."""
        found = dict.fromkeys(cell.perturb for cell in self.cells.values())
        return sorted(found, key=lambda name: name != NONE)

    def means(self, perturb: str | None = None) -> list[Line]:
        """One line a method over all scenes, undamaged unless said otherwise; the best first, the unknown last."""
        return self.ranked(lines(self.cells, perturb or self.perturbs[0], self.scenes))

    def ranked(self, found: Iterable[Line]) -> list[Line]:
        """Lines by the measure that methods are judged by."""
        losses = {line: self.loss(line, self.judged) for line in found}
        return sorted(losses, key=lambda line: (math.isnan(losses[line]), losses[line]))

    def loss(self, line: Line, measure: str) -> float:
        """A measure turned so that less is better; NaN where there is none."""
        value = line.measures.get(measure, math.nan)
        return value if self.task.measures[measure].best == "low" else -value

    def measured(self, scene: str) -> tuple[str, ...]:
        """The measures of a scene, in order: all of them, but for those of standard sets that no method has there."""
        there = {name for cell in self.cells.values() if cell.scene == scene for name in cell.measures}
        return tuple(name for name, each in self.task.measures.items() if not each.of_sets or name in there)

    def heading(self, measure: str, scenes: Sequence[str] | None = None) -> str:
        """Of a column: bad2 of scenes at a quarter of their size is `bad2@Q`, for tables of the full size call it bad8.

        scenes: those that the column is of; all of them if left out.
        """
        known = self.task.measures[measure]
        name, _, unit = known.title.partition(" ")
        sizes = {self.task.size_of(scene) for scene in scenes or self.scenes}
        size = sizes.pop() if len(sizes) == 1 else ""
        return f"{name}@{size} {unit}" if known.at_size and size else known.title

    @property
    def failed(self) -> list[str]:
        """Methods without a result on any scene, in order."""
        done = {cell.method for cell in self.cells.values() if cell.is_measured}
        return [name for name in dict.fromkeys(cell.method for cell in self.cells.values()) if name not in done]

    @property
    def judged(self) -> str:
        """The measure that methods are judged by."""
        return self.task.columns[0]

    def on_front(self, found: Sequence[Line], measure: str) -> list[int]:
        """Indices of the lines that none beats in time and in a measure."""
        return front([(line.seconds, self.loss(line, measure)) for line in found])


@dataclass(frozen=True)
class Table:
    """Headings and rows; the first column is text, the others are numbers."""

    title: str
    headings: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]


def tables(results: Results, detail: bool = False) -> list[Table]:
    """The mean over the scenes; what perturbations do; with `detail`, each scene and every measure; what failed."""
    count = len(results.scenes)
    title = (f"mean of {count} scenes" if count > 1 else results.scenes[0]) + _damaged(results.perturbs[0])
    found = [_figures(results, results.means(), title, results.task.columns, results.scenes)]
    if len(results.perturbs) > 1:
        found.append(_perturbed(results))
    if detail:
        found += [
            _figures(
                results,
                results.ranked(lines(results.cells, perturb, [scene])),
                scene + _damaged(perturb),
                results.measured(scene),
                [scene],
            )
            for scene in results.scenes
            for perturb in results.perturbs
        ]
    failures = _failures(results)
    return [*found, failures] if failures.rows else found


def _damaged(perturb: str) -> str:
    return "" if perturb == NONE else f", {perturb}"


def _figures(
    results: Results, found: Sequence[Line], title: str, measures: Sequence[str], scenes: Sequence[str]
) -> Table:
    known, clock = results.task.measures, results.task.clock
    best = results.on_front(found, results.judged)
    ratio = ("time / baseline",) if results.baseline else ()
    rows = [
        (
            line.method,
            FRONT if index in best else "",
            _number(clock.per_second * line.seconds, 1),
            *((_number(line.ratio, 2),) if ratio else ()),
            _number(line.memory_bytes / 1e6, 1),
            *(_number(line.measures.get(name, math.nan), known[name].digits) for name in measures),
        )
        for index, line in enumerate(found)
    ]
    measured = (results.heading(name, scenes) for name in measures)
    return Table(title, ("method", FRONT, clock.unit, *ratio, "peak MB", *measured), tuple(rows))


def _perturbed(results: Results) -> Table:
    measure, heading = results.task.measures[results.judged], results.heading(results.judged)
    by_name = {name: {line.method: line for line in results.means(name)} for name in results.perturbs}
    rows = [
        (
            line.method,
            *(
                _number(by_name[name][line.method].measures.get(results.judged, math.nan), measure.digits)
                for name in by_name
            ),
        )
        for line in results.means()
    ]
    return Table(
        f"{heading} under perturbations, mean of {len(results.scenes)} scenes",
        ("method", *by_name),
        tuple(rows),
    )


def _failures(results: Results) -> Table:
    failed: dict[tuple[str, str], list[str]] = {}
    for cell in results.cells.values():
        if cell.error:
            failed.setdefault((cell.method, cell.error), []).append(cell.scene + _damaged(cell.perturb))
    rows = [(method, _first_of(places), why) for (method, why), places in failed.items()]
    return Table("no result", ("method", "where", "why"), tuple(rows))


def _first_of(places: Sequence[str]) -> str:
    return places[0] if len(places) == 1 else f"{places[0]} and {len(places) - 1} more"


def _number(value: float, digits: int) -> str:
    return f"{value:.{digits}f}" if math.isfinite(value) else "-"
