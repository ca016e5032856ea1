"""A verdict: one number, the bound it is held against, where the bound comes from, and the cure."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

Grade = Literal["ok", "warn", "unsafe"]
"""`warn`: it will not feel as it should. `unsafe`: the device may buzz, or be driven too late."""
FEW = 0.01
"""Share of the surface up to which a place is called the exception."""

Unit = Literal["m", "s", "N", "N/m", "N s/m", "share"]


@dataclass(frozen=True)
class Verdict:
    """What one check says of one thing."""

    check: str
    of: str
    """What was looked at: `the law`, a material, a size of features."""
    verdict: Grade
    value: float
    unit: Unit
    relation: Literal["<=", ">=", ""] = ""
    """What the value is to be to the bound; empty for a figure that has none."""
    bound: float = math.nan
    source: str = ""
    """Where the bound comes from."""
    note: str = ""
    cure: str = ""
    """What to change to what; empty where all is well."""


def held(
    check: str,
    of: str,
    value: float,
    relation: Literal["<=", ">="],
    bound: float,
    unit: Unit,
    source: str,
    *,
    cure: str,
    worse: Grade = "warn",
    note: str = "",
) -> Verdict:
    """`ok` where the value keeps its bound; else `worse`, with the cure. A value at its bound keeps it; NaN keeps none.

    >>> held("stiffness", "the law", 800.0, "<=", 600.0, "N/m", "", cure="soften it", worse="unsafe").verdict
    'unsafe'
    """
    within = value <= bound if relation == "<=" else value >= bound
    keeps = within or math.isclose(value, bound)
    return Verdict(
        check, of, "ok" if keeps else worse, value, unit, relation, bound, source, note, "" if keeps else cure
    )


def under(value: float) -> str:
    """Two digits, rounded down: what to write into a file for a value that may be at most this.

    >>> under(1287.0), under(0.00999)
    ('1200', '0.0099')
    """
    return _two_digits(value, math.floor)


def over(value: float) -> str:
    """Two digits, rounded up: what to write into a file for a value that must be at least this.

    >>> over(1287.0), over(0.00061)
    ('1300', '0.00061')
    """
    return _two_digits(value, math.ceil)


def _two_digits(value: float, whole: Callable[[float], int]) -> str:
    if not 0 < value < math.inf:
        return f"{value:g}"
    decimals = 1 - math.floor(math.log10(value))
    return f"{whole(round(value * 10.0**decimals, 9)) / 10.0**decimals:.15g}"
