"""Verdicts: a value, its bound, the source of the bound, and the cure; as text and as JSON data."""

import json
import math
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any, Literal, NamedTuple

Grade = Literal["ok", "warn", "unsafe", "illegible"]
"""`warn`: it will not feel as intended. `unsafe`: the device may buzz. `illegible`: fingers cannot read it."""
FEW = 0.01  # share of the surface up to which places count as exceptions

Unit = Literal["m", "s", "N", "N/m", "N s/m", "share", "pins", "parts", "textures", "JND"]


class Change(NamedTuple):
    """A key of the configuration and its new value."""

    key: str
    value: str
    towards: Literal["at most", "at least", "is"]
    """Direction in which other values would do as well."""

    def __str__(self) -> str:
        return f"`{self.key}: {self.value}`"

    @property
    def setting(self) -> float | str:
        """The value as a number or a word, for JSON and `pipeline.editing.edited`."""
        try:
            return json.loads(self.value)
        except ValueError:
            return self.value

    def keeps(self, other: "Change") -> bool:
        """Test whether this value satisfies another change of the same key too."""
        if self.towards == other.towards:
            return True
        numbers = float(self.value), float(other.value)
        return numbers[0] >= numbers[1] if other.towards == "at least" else numbers[0] <= numbers[1]

    def stricter(self, other: "Change") -> "Change":
        """Return the one of two changes of a key that meets both bounds."""
        if self.towards == "is" or self.towards != other.towards:
            return self
        return (min if self.towards == "at most" else max)(self, other, key=lambda change: float(change.value))


Cure = str | Sequence[str | Change]


@dataclass(frozen=True)
class Verdict:
    """The result of one check of one thing."""

    check: str
    of: str
    """The thing checked: `the law`, a material, a size of features."""
    verdict: Grade
    value: float
    unit: Unit
    relation: Literal["<=", ">=", ""] = ""
    """Required relation of the value to the bound; empty for a value without a bound."""
    bound: float = math.nan
    source: str = ""
    note: str = ""
    cure: str = ""
    """Cure; empty for `ok`."""
    says: str = ""
    """Fault, as the end of a plain sentence; empty for `ok`."""
    changes: tuple[Change, ...] = ()
    """Changes of the configuration in the cure, the preferred one first."""
    at: tuple[tuple[float, float], ...] = ()
    """Places in the picture: shares of its width from the left and of its length from the top."""

    @property
    def keeps(self) -> bool:
        """True if the value meets its bound; a value at its bound does, NaN meets none."""
        within = self.value <= self.bound if self.relation == "<=" else self.value >= self.bound
        return not self.relation or within or math.isclose(self.value, self.bound)


def check_bound(
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
    """Return a verdict: `ok` if the value meets its bound, else `worse`, with the cure. NaN meets no bound.

    >>> check_bound("stiffness", "the law", 800.0, "<=", 600.0, "N/m", "", cure="soften it", worse="unsafe").verdict
    'unsafe'
    """
    fine = Verdict(check, of, "ok", value, unit, relation, bound, source, note)
    if fine.keeps:
        return fine
    parts = (cure,) if isinstance(cure, str) else cure
    changes = tuple(part for part in parts if isinstance(part, Change))
    return replace(fine, verdict=worse, cure="".join(map(str, parts)), says=says or f"{of} fails", changes=changes)


def under(value: float) -> str:
    """Format an upper bound for a file: two digits, rounded down.

    >>> under(1287.0), under(0.00999)
    ('1200', '0.0099')
    """
    return _two_digits(value, math.floor)


def over(value: float) -> str:
    """Format a lower bound for a file: two digits, rounded up.

    >>> over(1287.0), over(0.00061)
    ('1300', '0.00061')
    """
    return _two_digits(value, math.ceil)


def _two_digits(value: float, whole: Callable[[float], int]) -> str:
    if not 0 < value < math.inf:
        return f"{value:g}"
    decimals = 1 - math.floor(math.log10(value))
    return f"{whole(round(value * 10.0**decimals, 9)) / 10.0**decimals:.15g}"


MAX_DIGITS = 13
PREFIXES = ((1.0, ""), (1e-3, "m"), (1e-6, "u"))


def relation(verdict: Verdict) -> str:
    """Format the value and its true relation to the bound, with enough digits to show it.

    >>> relation(Verdict("damping", "the law", "warn", 3.215, "N s/m", "<=", 0.4))
    '3.215 N s/m > 0.4 N s/m'
    >>> relation(Verdict("stiffness", "the law", "unsafe", 3000.02, "N/m", "<=", 3000.0))
    '3000.02 N/m > 3000 N/m'
    """
    if not verdict.relation:
        return quantity(verdict.value, verdict.unit)
    if verdict.keeps:
        return f"{quantity(verdict.value, verdict.unit)} {verdict.relation} {quantity(verdict.bound, verdict.unit)}"
    numbers = verdict.value, verdict.bound
    if any(map(math.isnan, numbers)):
        return f"{verdict.value:g} must be {verdict.relation} {verdict.bound:g} {verdict.unit}"
    texts = ([quantity(number, verdict.unit, digits) for number in numbers] for digits in range(MAX_DIGITS))
    value, bound = next(
        (pair for pair in texts if pair[0] != pair[1]), [f"{number!r} {verdict.unit}" for number in numbers]
    )
    return f"{value} {'>' if verdict.relation == '<=' else '<'} {bound}"


def quantity(value: float, unit: str, more_digits: int = 0) -> str:
    """Format a value with its unit: three digits, four for newtons, plus `more_digits`.

    >>> quantity(2.9e-5, "m"), quantity(800.0, "N/m"), quantity(0.125, "share"), quantity(0.0, "s")
    ('29 um', '800 N/m', '12.5 %', '0 s')
    """
    if unit == "share":
        return f"{100 * value:.{3 + more_digits}g} %"
    if unit not in ("m", "s"):
        return f"{float(f'{value:.{4 + more_digits}g}'):.15g} {unit}"
    scale, prefix = next((unit for unit in PREFIXES if abs(value) >= unit[0]), PREFIXES[-1] if value else PREFIXES[0])
    return f"{value / scale:.{3 + more_digits}g} {prefix}{unit}"


def as_data(verdict: Verdict) -> dict[str, Any]:
    """Return a verdict as JSON data: its fields, its changes, and `stands`; values that are not finite become None."""
    infinite = [
        name for name, value in asdict(verdict).items() if isinstance(value, float) and not math.isfinite(value)
    ]
    plain = asdict(verdict) | dict.fromkeys(infinite)
    changes = [{"key": change.key, "value": change.setting, "towards": change.towards} for change in verdict.changes]
    return {**plain, "stands": relation(verdict), "changes": changes}
