"""Figures in words: shares, intervals, and how likely chance alone is."""

from math import inf, isfinite, isinf, isnan

from .rows import Row


def people(count: int) -> str:
    """Return a number of participants in words."""
    return "1 participant" if count == 1 else f"{count} participants"


def is_sure(row: Row) -> bool:
    """Return True if chance alone is not a likely reason: it is outside the interval, and p is below 0.05."""
    return row.estimate.has_interval and not row.estimate.holds(row.chance) and not row.p >= 0.05


def odds(row: Row) -> str:
    """Return how rarely chance alone gives a result as clear as this; "" if that is not rare."""
    if not row.p < 0.05:
        return ""
    studies = "fewer than 1 of 10,000" if row.p < 1e-4 else f"about 1 of {float(f'{1 / row.p:.1g}'):,.0f}"
    return f"If there were no difference, a result as clear as this would come about in {studies} studies."


def share(row: Row) -> str:
    """Return a share of the trials with its interval."""
    value, low, high = (100 * each for each in row.estimate)
    return f"{value:.0f} % of {row.trials} trials (95 % interval {low:.0f} to {high:.0f} %)"


def told_apart(row: Row, answered: str) -> str:
    """Return whether two conditions can be told apart. answered: who answered what rightly."""
    what, one, other = share(row), row.what.condition, row.what.other
    guess = f"guessing gives {100 * row.chance:.0f} %."
    if is_sure(row):
        return f"{one} and {other} can be told apart: {answered} in {what}; {guess}"
    return f"It is open whether {one} and {other} can be told apart: {answered} in {what}, and {guess}"


def interval(low: float, high: float) -> str:
    """Return the interval of an estimate."""
    if isnan(low):
        return "no interval from one value"
    if isinf(high):
        return f"95 % interval from {low:.3g} upwards" if isfinite(low) else "95 % interval without bounds"
    return f"95 % interval {low:.3g} to {high:.3g}" if isfinite(low) else f"95 % interval up to {high:.3g}"


def bound(row: Row) -> str:
    """Return an estimate that is the end of its interval."""
    _, low, high = row.estimate
    return f"below {high:.3g} {row.unit}" if high < inf else f"above {low:.3g} {row.unit}"
