"""How answers depend on a level that varies: functions that are fitted, where QUEST+ looks, how a model answers."""

from abc import ABC, abstractmethod
from collections.abc import Iterator
from math import inf, isinf
from typing import Any, ClassVar, NamedTuple, final

import numpy as np
from jaxtyping import Float64

from tangible_core.errors import TangibleError

from ..design import Comparison
from ..statistics.intervals import Estimate
from ..statistics.psychometric import GAUSSIAN, JND, Blocks, Curve, fit_choice, fit_difference
from ..trials import Answer
from .rows import (
    ByParticipant,
    Result,
    Row,
    What,
    bound_in_words,
    contrasts,
    group_answers,
    interval,
    over_participants,
    together,
)
from .shares import note_on_order

EQUALITY = "point of equality"
THRESHOLD = "threshold"
NOTICEABLE = "just noticeable difference"
WIDTH = "width"


class Threshold(NamedTuple):
    """The truth about a participant who is a model."""

    value: float | None  # threshold; None is that of the function
    shift: float  # how far above it this participant's is
    width: float  # distance of the levels at which 5 and 95 % of the way are done
    slope: float  # exponent of the function of a distance


class Function(ABC):
    """A psychometric function."""

    main: ClassVar[str]
    contrast_measures: ClassVar[tuple[str, ...]]
    """Measures by which conditions are compared."""

    @abstractmethod
    def intensities(self, levels: Float64[np.ndarray, "n"], standard: float | None) -> Float64[np.ndarray, "n"]:
        """Return levels on the axis of the function."""

    @abstractmethod
    def hit(self, answer: Answer) -> int | None:
        """Return 1 for an answer that counts, 0 for another one."""

    @abstractmethod
    def fit(self, blocks: Blocks, span: tuple[float, float]) -> Curve:
        """Fit it. span: least and greatest intensity of the study. Raises: ConfigError without psignifit."""

    @abstractmethod
    def grid(self, intensities: Float64[np.ndarray, "n"], lapses: tuple[float, ...]) -> tuple[str, dict[str, Any]]:
        """Return the name that QUEST+ has for it, and the values of its parameters."""

    @abstractmethod
    def share(self, level: float, comparison: Comparison, truth: Threshold) -> float:
        """Return the probability of an answer that counts."""

    @abstractmethod
    def figures(self, curve: Curve, comparison: Comparison) -> list[tuple[str, Estimate, str, float]]:
        """Return measures of a fit, each with its estimate, unit, and value by chance alone."""

    def notes(self, answers: list[Answer]) -> list[str]:
        """Return what a reader should know about the answers."""
        return []

    def describe(self, result: Result, row: Row) -> Iterator[str]:
        """Yield sentences about the main measure in one condition."""
        _, low, high = row.estimate
        if isinf(high) and low in (-inf, 0.0):
            yield f"With {row.what.condition}, the answers do not tell the {self.main}: any level explains them."
        elif row.estimate.is_bound:
            yield f"With {row.what.condition}, {self.meaning(row)} is {bound_in_words(row)} (95 %)."
        else:
            yield from self.describe_estimate(result, row)

    @abstractmethod
    def meaning(self, row: Row) -> str:
        """Return what the main measure is, in words."""

    @abstractmethod
    def describe_estimate(self, result: Result, row: Row) -> Iterator[str]:
        """Yield sentences about an estimate that is not only a bound."""


@final
class _Choice(Function):
    main = EQUALITY
    contrast_measures: ClassVar[tuple[str, ...]] = (EQUALITY, NOTICEABLE)

    def intensities(self, levels: Float64[np.ndarray, "n"], standard: float | None) -> Float64[np.ndarray, "n"]:
        return levels

    def hit(self, answer: Answer) -> int | None:
        return answer.chosen

    def fit(self, blocks: Blocks, span: tuple[float, float]) -> Curve:
        return fit_choice(blocks, span)

    def grid(self, intensities: Float64[np.ndarray, "n"], lapses: tuple[float, ...]) -> tuple[str, dict[str, Any]]:
        span = _span(intensities)
        means = np.linspace(intensities.min(), intensities.max(), 31)
        deviations = np.geomspace(span / 30, 2 * span, 12)
        return "norm_cdf", {"mean": means, "sd": deviations, "lower_asymptote": list(lapses[:1])}

    def share(self, level: float, comparison: Comparison, truth: Threshold) -> float:
        from scipy import stats

        equal = equal_level(comparison, truth)
        return float(stats.norm.cdf((level - equal) / (truth.width / GAUSSIAN)))

    def figures(self, curve: Curve, comparison: Comparison) -> list[tuple[str, Estimate, str, float]]:
        standard = comparison.standard if comparison.standard is not None else np.nan
        noticeable = curve.width.map(lambda width: JND * width)
        return [
            (EQUALITY, curve.threshold, comparison.unit, standard),
            (NOTICEABLE, noticeable, comparison.unit, np.nan),
            (WIDTH, curve.width, comparison.unit, np.nan),
        ]

    def notes(self, answers: list[Answer]) -> list[str]:
        return note_on_order(answers)

    def meaning(self, row: Row) -> str:
        return f"what feels equal to the standard, {row.chance:.3g} {row.unit},"

    def describe_estimate(self, result: Result, row: Row) -> Iterator[str]:
        (value, low, high), unit, condition = row.estimate, row.unit, row.what.condition
        equal = f"feels equal to the standard, {row.chance:.3g} {unit}"
        yield f"With {condition}, {value:.3g} {unit} {equal} ({interval(low, high)})."
        for jnd_row in result.of_all(NOTICEABLE):
            if jnd_row.what.condition == condition and not isinf(jnd_row.estimate.high):
                yield f"A difference of {jnd_row.estimate.value:.3g} {unit} is noticed in three of four trials."


@final
class _Distance(Function):
    main = THRESHOLD
    contrast_measures: ClassVar[tuple[str, ...]] = (THRESHOLD,)

    def intensities(self, levels: Float64[np.ndarray, "n"], standard: float | None) -> Float64[np.ndarray, "n"]:
        return np.abs(levels - (standard or 0.0))

    def hit(self, answer: Answer) -> int | None:
        return answer.correct

    def fit(self, blocks: Blocks, span: tuple[float, float]) -> Curve:
        return fit_difference(blocks, span)

    def grid(self, intensities: Float64[np.ndarray, "n"], lapses: tuple[float, ...]) -> tuple[str, dict[str, Any]]:
        span = _span(intensities)
        thresholds = np.geomspace(span / 30, 2 * max(span, float(intensities.max())), 30)
        return "weibull", {"threshold": thresholds, "slope": [1.0, 2.0, 4.0], "lower_asymptote": [1 / 3]}

    def share(self, level: float, comparison: Comparison, truth: Threshold) -> float:
        distances = self.intensities(np.array([level, *comparison.levels]), comparison.standard)
        farthest = float(distances[1:].max())
        threshold = max((truth.value or farthest / 2) + truth.shift, 1e-3 * farthest)
        return 1 / 3 + 2 / 3 * (1 - 0.5 ** ((float(distances[0]) / threshold) ** truth.slope))

    def figures(self, curve: Curve, comparison: Comparison) -> list[tuple[str, Estimate, str, float]]:
        return [(THRESHOLD, curve.threshold, comparison.unit, np.nan), (WIDTH, curve.width, "ln", np.nan)]

    def meaning(self, row: Row) -> str:
        return "the difference that is named rightly in two of three trials"

    def describe_estimate(self, result: Result, row: Row) -> Iterator[str]:
        (value, low, high), condition = row.estimate, row.what.condition
        sentence = f"a difference of {value:.3g} {row.unit} is named rightly in two of three trials"
        yield f"With {condition}, {sentence} ({interval(low, high)})."


# How often a level is chosen over the standard: a cumulative Gaussian, whose middle feels equal.
CHOICE = _Choice()
# How often the odd one of three is found: a Weibull function of the distance from the standard.
DISTANCE = _Distance()


def equal_level(comparison: Comparison, truth: Threshold) -> float:
    """Return the level that feels equal to the standard."""
    return ((comparison.standard or 0.0) if truth.value is None else truth.value) + truth.shift


def _span(intensities: Float64[np.ndarray, "n"]) -> float:
    return float(np.ptp(intensities)) or abs(float(intensities[0])) or 1.0


def analyse_levels(comparison: Comparison, answers: ByParticipant, function: Function) -> Result:
    """Fit a function to the answers of each participant in each condition, and compare the conditions."""
    curves: dict[str, Curve] = {}
    blocks: dict[str, Blocks] = {}
    rows: list[Row] = []
    unfit: list[str] = []
    for name, some in answers.items():
        for condition, cell in group_answers(some, lambda each: each.condition).items():
            key = f"{name}/{condition}"
            blocks[key] = answer_blocks(cell, function)
            if len(blocks[key].levels) < 2:
                unfit.append(key)
                continue
            levels = np.array(comparison.levels) if comparison.levels else blocks[key].levels
            span = function.intensities(levels, comparison.standard)
            curves[key] = function.fit(blocks[key], (float(span.min()), float(span.max())))
            rows += [
                Row(What(measure, condition), name, estimate, unit, len(cell), None, chance)
                for measure, estimate, unit, chance in function.figures(curves[key], comparison)
            ]
    if not rows:
        raise TangibleError(f"{comparison.name}: has answers at one level only; run it to the end")
    if len(answers) > 1:
        rows += over_participants(rows)
    for measure in function.contrast_measures:
        rows += contrasts(measure, rows)
    notes = function.notes(together(answers))
    notes += [f"{key} has answers at one level only, and no function." for key in unfit]
    notes += [
        f"The threshold of {key} is outside the levels that were presented; it is a guess."
        for key, curve in curves.items()
        if not (curve.threshold.is_bound or min(blocks[key].levels) <= curve.threshold.value <= max(blocks[key].levels))
    ]
    return Result(comparison.name, comparison.question, list(answers), rows, function.main, curves, blocks, notes)


def answer_blocks(answers: list[Answer], function: Function) -> Blocks:
    """Return answers by level, on the axis of the function."""

    def where(answer: Answer) -> float:
        return float(function.intensities(np.array([answer.level or 0.0]), answer.standard)[0])

    cells = sorted(group_answers(answers, where).items())
    hits = [[function.hit(answer) or 0 for answer in cell] for _, cell in cells]
    return Blocks(
        np.array([level for level, _ in cells], float),
        np.array([sum(hit) for hit in hits], float),
        np.array([len(hit) for hit in hits], float),
    )
