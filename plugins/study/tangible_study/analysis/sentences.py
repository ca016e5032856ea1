"""Plain sentences: what was found, and how sure that is."""

from collections.abc import Iterator
from math import inf, isfinite, isinf, isnan

from ..measures.curves import EQUALITY, NOTICEABLE, THRESHOLD
from ..measures.pairs import CHOSEN, DIFFERENCE, SCALE
from ..measures.quantities import ERROR, RATING
from ..measures.right_answers import CORRECT
from ..measures.rows import Result, Row
from .results_folder import Kept

FEW = 6
"""Number of participants below which a result says little about other people."""
MANY = 3
"""Number of comparisons from which one may seem to differ by chance."""


def sentences(result: Result) -> list[str]:
    """Return what was found in one comparison, and how sure that is; notes come last."""
    who = people(len(result.participants))
    told = [text for row in result.of_all(result.main) for text in _describe(result, row, who)]
    contrasts = [row for row in result.rows if row.what.measure == f"difference of {result.main}"]
    told += list(_scale(result)) if result.main == SCALE else []
    told += [text for row in contrasts if row.what.measure != DIFFERENCE for text in _difference(result.main, row)]
    against_chance = [] if result.main == CORRECT and contrasts else result.of_all(result.main)
    tests = len([each for each in against_chance if each.p == each.p]) + len(contrasts)
    if tests >= MANY:
        told.append(f"{tests} differences were looked for: if there were none, about one in 20 would seem to be there.")
    if len(result.participants) < FEW:
        told.append(f"The result is about {who}, and says little about other people.")
    return [*told, *result.notes]


def counts(kept: Kept) -> str:
    """Return how many answers count, and which were left out."""
    return (
        f"{kept.trials} answers of {people(len(kept.answers))} count; {kept.training} training trials and "
        f"{kept.not_rendered} that the device did not render as requested are left out."
    )


def people(count: int) -> str:
    """Return a number of participants in words."""
    return "1 participant" if count == 1 else f"{count} participants"


def is_sure(row: Row) -> bool:
    """Return True if chance alone is not a likely reason: it is outside the interval, and p is below 0.05."""
    return row.estimate.has_interval and not row.estimate.holds(row.chance) and not row.p >= 0.05


def odds(p: float) -> str:
    """Return a probability as a count of studies."""
    return "fewer than 1 of 10,000" if p < 1e-4 else f"about 1 of {float(f'{1 / p:.1g}'):,.0f}"


def _describe(result: Result, row: Row, who: str) -> Iterator[str]:
    """Yield sentences about one figure of all participants."""
    value, low, high = row.estimate
    one, other, trials, unit = row.what.condition, row.what.other, row.trials, row.unit
    share = f"{100 * value:.0f} % of {trials} trials (95 % interval {100 * low:.0f} to {100 * high:.0f} %)"
    between = _interval(low, high)
    bound = f"below {high:.3g} {unit}" if high < inf else f"above {low:.3g} {unit}"
    guess = 100 * row.chance
    match row.what.measure:
        case "proportion correct" if result.question == "same":
            yield (
                f"{one} and {other} can be told apart: {who} found the odd one in {share}; "
                f"guessing gives {guess:.0f} %."
                if is_sure(row)
                else f"It is open whether {one} and {other} can be told apart: {who} found the odd one in {share}, "
                f"and guessing gives {guess:.0f} %."
            )
        case "proportion correct" if result.question == "different":
            yield (
                f"{one} and {other} can be told apart: {who} answered rightly in {share}; guessing gives {guess:.0f} %."
                if is_sure(row)
                else f"It is open whether {one} and {other} can be told apart: {who} answered rightly in {share}, and "
                f"guessing gives {guess:.0f} %."
            )
        case "proportion correct":
            yield f"With {one}, {who} named the right part in {share}; guessing gives {guess:.0f} %."
        case "proportion chosen":
            more, less = (one, other) if value >= 0.5 else (other, one)
            yield (
                f"{more} is {result.question} than {less}: {who} chose {one} in {share}; no difference gives 50 %."
                if is_sure(row)
                else f"It is open whether {more} is {result.question} than {less}: {who} chose {one} in {share}, and "
                "no difference gives 50 %."
            )
        case "point of equality" | "threshold" if isinf(high) and low in (-inf, 0.0):
            yield f"With {one}, the answers do not tell the {row.what.measure}: any level explains them."
        case "point of equality" if row.estimate.is_bound:
            yield f"With {one}, what feels equal to the standard, {row.chance:.3g} {unit}, is {bound} (95 %)."
        case "threshold" if row.estimate.is_bound:
            yield f"With {one}, the difference that is named rightly in two of three trials is {bound} (95 %)."
        case "point of equality":
            yield f"With {one}, {value:.3g} {unit} feels equal to the standard, {row.chance:.3g} {unit} ({between})."
            for noticed in result.of_all(NOTICEABLE):
                if noticed.what.condition == one and not isinf(noticed.estimate.high):
                    yield f"A difference of {noticed.estimate.value:.3g} {unit} is noticed in three of four trials."
        case "threshold":
            yield f"With {one}, a difference of {value:.3g} {unit} is named rightly in two of three trials ({between})."
        case "constant error":
            side = "above" if value > 0 else "below"
            yield f"With {one}, {who} went {abs(value):.3g} {unit} {side} the standard on average ({between})."
        case "mean rating":
            yield f"{who} gave {one} a rating of {value:.3g} on average ({between})."
        case _:
            return
    if row.p < 0.05:
        yield f"If there were no difference, a result as clear as this would come about in {odds(row.p)} studies."


def _interval(low: float, high: float) -> str:
    """Return the interval of an estimate in words."""
    if isnan(low):
        return "no interval from one value"
    if isinf(high):
        return f"95 % interval from {low:.3g} upwards" if isfinite(low) else "95 % interval without bounds"
    return f"95 % interval {low:.3g} to {high:.3g}" if isfinite(low) else f"95 % interval up to {high:.3g}"


def _difference(measure: str, row: Row) -> Iterator[str]:
    """Yield sentences about a difference between two conditions."""
    what = NAMES[measure]
    one, other = row.what.condition, row.what.other
    value, low, high = (100 * each for each in row.estimate) if measure == CORRECT else row.estimate
    unit = "percentage points" if measure == CORRECT else row.unit
    more = "greater" if value > 0 else "smaller"
    least, most = (low, high) if value > 0 else (-high, -low)
    amount, between = f"{abs(value):.3g} {unit}".rstrip(), _interval(least, most)
    if not row.estimate.has_interval:
        yield f"With {one}, {what} is {amount} {more} than with {other}; one value each does not tell how sure that is."
    elif is_sure(row) and isinf(value):
        yield f"With {one}, {what} is {more} than with {other}, by {least:.3g} {unit} or more (95 %)."
    elif is_sure(row):
        yield f"With {one}, {what} is {amount} {more} than with {other} ({between})."
        if row.p < 0.05:
            yield f"If there were no difference, a result as clear as this would come about in {odds(row.p)} studies."
    elif isfinite(value):
        yield (
            f"It is open whether {what} differs: with {one}, it is {amount} {more} than with {other} "
            f"({between}, which holds 0)."
        )
    else:
        yield f"It is open whether {what} differs between {one} and {other}: one of them has a bound, no estimate."


def _scale(result: Result) -> Iterator[str]:
    """Yield sentences about a scale of paired comparisons."""
    values = sorted(result.of_all(SCALE), key=lambda row: -row.estimate.value)
    yield f"From most to least {result.question.removesuffix('er')}: {', '.join(row.what.condition for row in values)}."
    open_pairs = [row.what for row in result.of_all(DIFFERENCE) if not is_sure(row)]
    if open_pairs:
        listed = "; ".join(f"{each.condition} and {each.other}" for each in open_pairs)
        yield f"Which of these is more is open: {listed}."
    else:
        yield "Each of them differs from each other one: 0 is outside the 95 % interval of every difference."


NAMES = {
    CORRECT: "the share of parts named rightly",
    CHOSEN: "the share of choices",
    EQUALITY: "the level that feels equal",
    THRESHOLD: "the threshold",
    ERROR: "the constant error",
    RATING: "the rating",
}
"""Measures in sentences."""
