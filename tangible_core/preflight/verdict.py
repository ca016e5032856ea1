"""A verdict: one number, the bound it is held against, where the bound comes from, and the cure; and all of them."""

import json
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Literal, NamedTuple

Grade = Literal["ok", "warn", "unsafe", "illegible"]
"""`warn`: it will not feel as it should. `unsafe`: the device may buzz, or be driven too late. `illegible`: fingers
cannot read it."""
FEW = 0.01
"""Share of the surface up to which a place is called the exception."""

Unit = Literal["m", "s", "N", "N/m", "N s/m", "share", "pins", "parts", "textures", "JND"]


class Change(NamedTuple):
    """A key of the configuration, and what to write there."""

    key: str
    value: str
    towards: Literal["at most", "at least", "is"]
    """Which other values would do as well."""

    def __str__(self) -> str:
        return f"`{self.key}: {self.value}`"

    @property
    def setting(self) -> float | str:
        """The value as JSON and `pipeline.editing.edited` take it: a number, or a word."""
        try:
            return json.loads(self.value)
        except ValueError:
            return self.value

    def keeps(self, other: "Change") -> bool:
        """Whether the other, of the same key, is content with this value too."""
        if self.towards == other.towards:
            return True
        numbers = float(self.value), float(other.value)
        return numbers[0] >= numbers[1] if other.towards == "at least" else numbers[0] <= numbers[1]

    def stricter(self, other: "Change") -> "Change":
        """Of two for one key, the one that keeps both bounds."""
        if self.towards == "is" or self.towards != other.towards:
            return self
        return (min if self.towards == "at most" else max)(self, other, key=lambda each: float(each.value))


Cure = str | Sequence[str | Change]
"""What to change to what: a text, or its parts in order."""


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
    says: str = ""
    """What is wrong, as the end of a plain sentence; empty where all is well."""
    changes: tuple[Change, ...] = ()
    """What of the cure a configuration can say, the first that does first."""
    at: tuple[tuple[float, float], ...] = ()
    """Where it is in the picture: shares of its width from the left and of its length from the top."""

    @property
    def keeps(self) -> bool:
        """Whether the value keeps its bound; one at its bound does, NaN keeps none."""
        within = self.value <= self.bound if self.relation == "<=" else self.value >= self.bound
        return not self.relation or within or math.isclose(self.value, self.bound)


def held(
    check: str,
    of: str,
    value: float,
    relation: Literal["<=", ">="],
    bound: float,
    unit: Unit,
    source: str,
    *,
    cure: Cure,
    says: str = "",
    worse: Grade = "warn",
    note: str = "",
) -> Verdict:
    """`ok` where the value keeps its bound; else `worse`, with the cure. A value at its bound keeps it; NaN keeps none.

    >>> held("stiffness", "the law", 800.0, "<=", 600.0, "N/m", "", cure="soften it", worse="unsafe").verdict
    'unsafe'
    """
    fine = Verdict(check, of, "ok", value, unit, relation, bound, source, note)
    if fine.keeps:
        return fine
    parts = (cure,) if isinstance(cure, str) else cure
    changes = tuple(part for part in parts if isinstance(part, Change))
    return replace(fine, verdict=worse, cure="".join(map(str, parts)), says=says or f"{of} fails", changes=changes)


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
