"""Plain sentences: what was found, and how sure that is."""

from collections.abc import Iterator
from math import isfinite, isinf

from ..measures.pairs import SCALE
from ..measures.rows import Result, Row
from ..measures.shares import CORRECT
from ..measures.words import interval, is_sure, odds, people
from ..questions import load_question
from .results_folder import Kept

FEW = 6
"""Number of participants below which a result says little about other people."""
MANY = 3
"""Number of comparisons from which one may seem to differ by chance."""


def sentences(result: Result) -> list[str]:
    """Return what was found in one comparison, and how sure that is; notes come last."""
    who, question = people(len(result.participants)), load_question(result.question)
    told = list(question.conclude(result, who))
    contrasts = [row for row in result.rows if row.what.measure == f"difference of {result.main}"]
    if result.main != SCALE:
        noun = question.nouns.get(result.main, f"the {result.main}")
        told += [text for row in contrasts for text in _difference(result.main, noun, row)]
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


def _difference(measure: str, what: str, row: Row) -> Iterator[str]:
    """Yield sentences about a difference between two conditions."""
    one, other = row.what.condition, row.what.other
    value, low, high = (100 * each for each in row.estimate) if measure == CORRECT else row.estimate
    unit = "percentage points" if measure == CORRECT else row.unit
    more = "greater" if value > 0 else "smaller"
    least, most = (low, high) if value > 0 else (-high, -low)
    amount, between = f"{abs(value):.3g} {unit}".rstrip(), interval(least, most)
    if not row.estimate.has_interval:
        yield f"With {one}, {what} is {amount} {more} than with {other}; one value each does not tell how sure that is."
    elif is_sure(row) and isinf(value):
        yield f"With {one}, {what} is {more} than with {other}, by {least:.3g} {unit} or more (95 %)."
    elif is_sure(row):
        yield f"With {one}, {what} is {amount} {more} than with {other} ({between})."
        if rare := odds(row):
            yield rare
    elif isfinite(value):
        yield (
            f"It is open whether {what} differs: with {one}, it is {amount} {more} than with {other} "
            f"({between}, which holds 0)."
        )
    else:
        yield f"It is open whether {what} differs between {one} and {other}: one of them has a bound, no estimate."
