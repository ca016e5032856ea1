"""Figures of rows: medians over repeats, means over scenes, ratios to a baseline within each round."""

import math
import statistics
from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence, Set
from dataclasses import dataclass, field

from ..measuring.rows import Row

NAN = float("nan")
Key = tuple[str, str, str]
"""Method, scene, perturbation."""


@dataclass(frozen=True)
class Cell:
    """The results of a method on a scene with a perturbation; lists hold one value for each repeat."""

    method: str
    scene: str
    perturb: str
    scene_digest: str = ""
    seconds: Sequence[float] = ()
    first_seconds: Sequence[float] = ()
    # Times divided by the baseline's time in the same round; empty without a baseline.
    ratios: Sequence[float] = ()
    memory_bytes: Sequence[float] = ()
    # Medians over the repeats. (Methods are deterministic, so each repeat has the same value.)
    measures: Mapping[str, float] = field(default_factory=dict[str, float])
    error: str | None = None

    @property
    def is_measured(self) -> bool:
        """True if any repeat has a result; after `errors_only`, results have no times."""
        return bool(self.seconds or self.measures)

    @property
    def key(self) -> Key:
        """The method, scene and perturbation."""
        return self.method, self.scene, self.perturb


@dataclass(frozen=True, eq=False)
class Line:
    """A method's figures over several scenes; NaN where the method lacks a result that another method has."""

    method: str
    perturb: str
    seconds: float  # the mean of the scenes' medians
    first_seconds: float
    ratio: float  # the geometric mean of the scenes' median ratios, so that large scenes do not count for more
    memory_bytes: float  # the largest memory of any scene
    measures: Mapping[str, float]  # the means over the scenes, with equal weights
    done: int  # the number of scenes with a result
    scenes: int


def cells(rows: Iterable[Row], baseline: str | None) -> dict[Key, Cell]:
    """Group rows by method, scene and perturbation, in the order of their first appearance."""
    rows_by_cell: dict[Key, list[Row]] = defaultdict(list)
    for row in rows:
        rows_by_cell[row.cell].append(row)
    return {
        key: _cell(of_cell, _times(rows_by_cell.get((baseline or "", *key[1:]), ())))
        for key, of_cell in rows_by_cell.items()
    }


def lines(all_cells: Mapping[Key, Cell], perturb: str, scenes: Sequence[str]) -> list[Line]:
    """Return a line for each method, over these scenes under one perturbation."""
    methods = dict.fromkeys(cell.method for cell in all_cells.values())
    with_value = {
        (cell.scene, name)
        for cell in all_cells.values()
        for name, value in cell.measures.items()
        if not math.isnan(value)
    }
    return [
        _line(method, perturb, [all_cells.get((method, scene, perturb)) for scene in scenes], with_value)
        for method in methods
    ]


def median(values: Iterable[float]) -> float:
    """Return the median; NaN of an empty list."""
    numbers = list(values)
    return statistics.median(numbers) if numbers else NAN


def spread(values: Sequence[float]) -> float:
    """Return 1.4826 times the median absolute deviation (Rousseeuw & Croux, JASA 88, 1993); 0 of an empty list."""
    return 1.4826 * median(abs(value - median(values)) for value in values) if values else 0.0


def _times(rows: Iterable[Row]) -> dict[int, float]:
    return {row.repeat: row.seconds for row in rows if row.seconds is not None}


def _cell(rows: Sequence[Row], baseline: Mapping[int, float]) -> Cell:
    good = [row for row in rows if row.error is None]
    names = dict.fromkeys(name for row in good for name in row.measures)
    errors = [row.error for row in rows if row.error]
    return Cell(
        *rows[0].cell,
        scene_digest=rows[-1].scene_digest,
        seconds=[row.seconds for row in good if row.seconds is not None],
        first_seconds=[row.first_seconds for row in good if row.first_seconds is not None],
        ratios=[row.seconds / baseline[row.repeat] for row in good if row.seconds and baseline.get(row.repeat)],
        memory_bytes=[row.peak_memory_bytes for row in good if row.peak_memory_bytes is not None],
        measures={
            name: median(value for row in good if (value := row.measures.get(name)) is not None) for name in names
        },
        error=errors[-1] if errors else None,
    )


def _line(method: str, perturb: str, of_scenes: Sequence[Cell | None], with_value: Set[tuple[str, str]]) -> Line:
    with_result = [cell for cell in of_scenes if cell is not None and cell.error is None and cell.is_measured]
    whole = with_result if len(with_result) == len(of_scenes) else []
    names = dict.fromkeys(name for cell in whole for name in cell.measures)
    return Line(
        method,
        perturb,
        seconds=_mean(median(cell.seconds) for cell in whole),
        first_seconds=_mean(median(cell.first_seconds) for cell in whole),
        ratio=math.exp(_mean(math.log(median(cell.ratios)) for cell in whole)),
        memory_bytes=max((median(cell.memory_bytes) for cell in whole), default=NAN),
        measures={
            name: _mean(cell.measures.get(name, NAN) for cell in whole if (cell.scene, name) in with_value)
            for name in names
        },
        done=len(with_result),
        scenes=len(of_scenes),
    )


def _mean(values: Iterable[float]) -> float:
    numbers = list(values)
    return statistics.fmean(numbers) if numbers else NAN
