"""Verdicts as text, with their relation to the bound, and as JSON data."""

import math
from dataclasses import asdict
from typing import Any

from .verdict import Verdict

MOST_DIGITS = 13
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
    texts = ([quantity(each, verdict.unit, digits) for each in numbers] for digits in range(MOST_DIGITS))
    value, bound = next(
        (pair for pair in texts if pair[0] != pair[1]), [f"{each!r} {verdict.unit}" for each in numbers]
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
    scale, prefix = next((each for each in PREFIXES if abs(value) >= each[0]), PREFIXES[-1] if value else PREFIXES[0])
    return f"{value / scale:.{3 + more_digits}g} {prefix}{unit}"


def as_data(verdict: Verdict) -> dict[str, Any]:
    """Return a verdict as JSON data: its fields, its changes, and `stands`, the text of `relation`.

    Each of `changes` has a `key` and a `value` for `pipeline.editing.edited`; values that are not finite become None.
    """
    plain = {name: _finite(value) for name, value in asdict(verdict).items()}
    changes = [{"key": each.key, "value": each.setting, "towards": each.towards} for each in verdict.changes]
    return {**plain, "stands": relation(verdict), "changes": changes}


def _finite(value: Any) -> Any:
    return None if isinstance(value, float) and not math.isfinite(value) else value
