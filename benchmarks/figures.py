"""What is promised and what was measured, side by side."""

import sys
from collections.abc import Callable, Iterable, Sequence
from statistics import fmean, stdev
from typing import Any, NamedTuple


class Figure(NamedTuple):
    """One promise: what it is about, the bound in words, what was measured, and whether that is within it."""

    what: str
    bound: str
    measured: str
    met: bool


def judged(figures: Iterable[Figure]) -> list[str]:
    """Return a Markdown table; what is not within its bound says `missed`."""
    rows = [(figure.what, figure.bound, figure.measured, "" if figure.met else "missed") for figure in figures]
    return table(("what", "bound", "measured", ""), rows)


def table(headings: tuple[str, ...], rows: Iterable[tuple[str, ...]]) -> list[str]:
    """Lines of a Markdown table."""
    return [_line(headings), "|" + "---|" * len(headings), *(_line(row) for row in rows)]


def mean_and_error(values: Sequence[float]) -> str:
    """Return the mean with its standard error; without, for a single value."""
    error = f" ± {stdev(values) / len(values) ** 0.5:.3f}" if len(values) > 1 else ""
    return f"{fmean(values):.3f}{error}"


def part(name: str, work: Callable[[], Any]) -> Any:
    """Return what `work` gives; its name is printed before, as it may take minutes."""
    print(f"  {name} ...", file=sys.stderr)
    return work()


def _line(cells: tuple[str, ...]) -> str:
    return f"| {' | '.join(cells)} |"
