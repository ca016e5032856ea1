"""Results as tables of text: means, perturbations, details and failures."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import product

from ..config.reading import NONE
from ..tasks.task import Task
from .summary import Cell, Line, lines

# The mark of a Pareto-optimal method: no other method beats it in time and error at once.
FRONT = "*"


def front(points: Sequence[tuple[float, ...]]) -> list[int]:
    """Return the indices of the Pareto-optimal points, in the order of their first coordinate; low is good.

    >>> front([(1, 9), (2, 5), (3, 6), (4, 1)])
    [0, 1, 3]
    """
    candidates = [index for index, point in enumerate(points) if not any(map(math.isnan, point))]
    unbeaten = [index for index in candidates if not any(_beats(points[other], points[index]) for other in candidates)]
    return sorted(unbeaten, key=lambda index: points[index])


def _beats(one: tuple[float, ...], other: tuple[float, ...]) -> bool:
    return one != other and all(low <= high for low, high in zip(one, other, strict=True))


@dataclass(frozen=True)
class Results:
    """All cells of a comparison, with its task and baseline."""

    task: Task
    cells: dict[tuple[str, str, str], Cell]
    baseline: str | None

    @property
    def scenes(self) -> list[str]:
        """The names of the scenes, in the order of their first cell."""
        return list(dict.fromkeys(cell.scene for cell in self.cells.values()))

    @property
    def perturbs(self) -> list[str]:
        """The names of the perturbations, in the order of their first cell, but `none` first."""
        names = dict.fromkeys(cell.perturb for cell in self.cells.values())
        return sorted(names, key=lambda name: name != NONE)

    def means(self, perturb: str | None = None) -> list[Line]:
        """Return a line for each method over all scenes, by default undamaged; the best first, the unknown last."""
        return self.rank(lines(self.cells, perturb or self.perturbs[0], self.scenes))

    def rank(self, some_lines: Iterable[Line]) -> list[Line]:
        """Return the lines in the order of the judged measure."""
        losses = {line: self.loss(line, self.main_measure) for line in some_lines}
        return sorted(losses, key=lambda line: (math.isnan(losses[line]), losses[line]))

    def loss(self, line: Line, measure: str) -> float:
        """Return a measure with such a sign that less is better; NaN if it is unknown."""
        value = line.measures.get(measure, math.nan)
        return value if self.task.measures[measure].best == "low" else -value

    def scene_measures(self, scene: str) -> tuple[str, ...]:
        """Return the measures of a scene, in order; those of standard sets only if a method has them there."""
        with_value = {name for cell in self.cells.values() if cell.scene == scene for name in cell.measures}
        return tuple(name for name, measure in self.task.measures.items() if not measure.of_sets or name in with_value)

    def heading(self, measure: str, scenes: Sequence[str] | None = None) -> str:
        """Return the heading of a column, such as `bad2@Q` where its scenes are at a quarter of their size."""
        title, at_size = self.task.measures[measure].title, self.task.measures[measure].at_size
        name, _, unit = title.partition(" ")
        sizes = {self.task.scene_size(scene) for scene in scenes or self.scenes}
        size = sizes.pop() if len(sizes) == 1 else ""
        return f"{name}@{size} {unit}" if at_size and size else title

    @property
    def methods_without_result(self) -> list[str]:
        """The methods without a result on any scene, in order."""
        with_result = {cell.method for cell in self.cells.values() if cell.is_measured}
        return [name for name in dict.fromkeys(cell.method for cell in self.cells.values()) if name not in with_result]

    @property
    def main_measure(self) -> str:
        """The measure that methods are judged by."""
        return self.task.columns[0]

    def on_front(self, means: Sequence[Line], measure: str) -> list[int]:
        """Return the indices of the lines that no other beats in time and in a measure."""
        return front([(line.seconds, self.loss(line, measure)) for line in means])


@dataclass(frozen=True)
class Table:
    """Headings and rows of text."""

    title: str
    headings: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]


def tables(results: Results, detail: bool = False) -> list[Table]:
    """Return the means over the scenes, effects of perturbations and failures; with `detail`, each scene too."""
    count = len(results.scenes)
    title = (f"mean of {count} scenes" if count > 1 else results.scenes[0]) + _suffix(results.perturbs[0])
    all_tables = [_figures(results, results.means(), title, results.task.columns, results.scenes)]
    if len(results.perturbs) > 1:
        all_tables.append(_perturbations(results))
    for scene, perturb in product(results.scenes, results.perturbs) if detail else ():
        of_scene = results.rank(lines(results.cells, perturb, [scene]))
        title = scene + _suffix(perturb)
        all_tables.append(_figures(results, of_scene, title, results.scene_measures(scene), [scene]))
    failures = _failures(results)
    return [*all_tables, failures] if failures.rows else all_tables


def _suffix(perturb: str) -> str:
    return "" if perturb == NONE else f", {perturb}"


def _figures(
    results: Results, means: Sequence[Line], title: str, measures: Sequence[str], scenes: Sequence[str]
) -> Table:
    all_measures, clock = results.task.measures, results.task.clock
    best = results.on_front(means, results.main_measure)
    ratio = ("time / baseline",) if results.baseline else ()
    rows = [
        (
            line.method,
            FRONT if index in best else "",
            _number(clock.per_second * line.seconds, 1),
            *((_number(line.ratio, 2),) if ratio else ()),
            _number(line.memory_bytes / 1e6, 1),
            *(_number(line.measures.get(name, math.nan), all_measures[name].digits) for name in measures),
        )
        for index, line in enumerate(means)
    ]
    headings = (results.heading(name, scenes) for name in measures)
    return Table(title, ("method", FRONT, clock.unit, *ratio, "peak MB", *headings), tuple(rows))


def _perturbations(results: Results) -> Table:
    main, digits = results.main_measure, results.task.measures[results.main_measure].digits
    by_name = {
        name: {line.method: line.measures.get(main, math.nan) for line in results.means(name)}
        for name in results.perturbs
    }
    rows = tuple(
        (line.method, *(_number(values[line.method], digits) for values in by_name.values()))
        for line in results.means()
    )
    title = f"{results.heading(main)} under perturbations, mean of {len(results.scenes)} scenes"
    return Table(title, ("method", *by_name), rows)


def _failures(results: Results) -> Table:
    places_of_error: dict[tuple[str, str], list[str]] = {}
    for cell in results.cells.values():
        if cell.error:
            places_of_error.setdefault((cell.method, cell.error), []).append(cell.scene + _suffix(cell.perturb))
    rows = tuple(
        (method, places[0] + (f" and {len(places) - 1} more" if len(places) > 1 else ""), why)
        for (method, why), places in places_of_error.items()
    )
    return Table("no result", ("method", "where", "why"), rows)


def _number(value: float, digits: int) -> str:
    return f"{value:.{digits}f}" if math.isfinite(value) else "-"
