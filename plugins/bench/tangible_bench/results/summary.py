"""From rows to figures: medians over repeats, means over scenes, ratios to a baseline pair by pair."""

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
    """What is known of a method on a scene with a perturbation; lists hold one value for each repeat."""

    method: str
    scene: str
    perturb: str
    scene_digest: str = ""
    seconds: Sequence[float] = ()
    first_seconds: Sequence[float] = ()
    ratios: Sequence[float] = ()
    """Time over the baseline's in the same round; empty without a baseline."""
    memory_bytes: Sequence[float] = ()
    measures: Mapping[str, float] = field(default_factory=dict[str, float])
    """Median over the repeats: methods are deterministic, so it is the value of each."""
    error: str | None = None

    @property
    def is_measured(self) -> bool:
        """Whether any repeat has a result; one without a time has errors alone."""
        return bool(self.seconds or self.measures)

    @property
    def key(self) -> Key:
        """What tells it from the other cells."""
        return self.method, self.scene, self.perturb


@dataclass(frozen=True, eq=False)
class Line:
    """A method's figures over several scenes; NaN where it lacks what another method has."""

    method: str
    perturb: str
    seconds: float
    """Mean of the scenes' medians."""
    first_seconds: float
    ratio: float
    """Geometric mean of the scenes' median ratios: no scene counts for more because it is larger."""
    memory_bytes: float
    """The scene that took the most."""
    measures: Mapping[str, float]
    """Mean over the scenes, each counting alike."""
    done: int
    """How many scenes have a result."""
    scenes: int


def cells(rows: Iterable[Row], baseline: str | None) -> dict[Key, Cell]:
    """Rows put together by method, scene and perturbation, in the order of their first appearance."""
    grouped: dict[Key, list[Row]] = defaultdict(list)
    for row in rows:
        grouped[row.cell].append(row)
    return {
        key: _cell(of_cell, _times(grouped.get((baseline or "", *key[1:]), ()))) for key, of_cell in grouped.items()
    }


def lines(found: Mapping[Key, Cell], perturb: str, scenes: Sequence[str]) -> list[Line]:
    """One line a method, over these scenes under one perturbation.

    A scene on which no method has a measure, such as one without truth, does not count in its mean.
    """
    methods = dict.fromkeys(cell.method for cell in found.values())
    told = {
        (cell.scene, name) for cell in found.values() for name, value in cell.measures.items() if not math.isnan(value)
    }
    return [
        _line(method, perturb, [found.get((method, scene, perturb)) for scene in scenes], told) for method in methods
    ]


def median(values: Iterable[float]) -> float:
    """NaN of nothing."""
    known = list(values)
    return statistics.median(known) if known else NAN


def spread(values: Sequence[float]) -> float:
    """Standard deviation of one value, from the median of the absolute deviations; 0 of nothing.

    Source: Rousseeuw & Croux, Alternatives to the Median Absolute Deviation, JASA 88 (1993): 1.4826 for a Gaussian.
    """
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
        measures={name: median(_known(row.measures.get(name) for row in good)) for name in names},
        error=errors[-1] if errors else None,
    )


def _known(values: Iterable[float | None]) -> list[float]:
    return [value for value in values if value is not None]


def _line(method: str, perturb: str, found: Sequence[Cell | None], told: Set[tuple[str, str]]) -> Line:
    done = [cell for cell in found if cell is not None and cell.error is None and cell.is_measured]
    whole = done if len(done) == len(found) else []
    names = dict.fromkeys(name for cell in whole for name in cell.measures)
    ratios = [median(cell.ratios) for cell in whole]
    return Line(
        method,
        perturb,
        seconds=_mean(median(cell.seconds) for cell in whole),
        first_seconds=_mean(median(cell.first_seconds) for cell in whole),
        ratio=math.exp(_mean(math.log(ratio) for ratio in ratios)),
        memory_bytes=max((median(cell.memory_bytes) for cell in whole), default=NAN),
        measures={
            name: _mean(cell.measures.get(name, NAN) for cell in whole if (cell.scene, name) in told) for name in names
        },
        done=len(done),
        scenes=len(found),
    )


def _mean(values: Iterable[float]) -> float:
    known = list(values)
    return statistics.fmean(known) if known else NAN
