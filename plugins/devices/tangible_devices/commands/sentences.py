"""Summaries of what was found of devices, one plain sentence each."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from tangible_core.cli.sentences import listing

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence


def devices_summary(rows: Sequence[Mapping[str, Any]]) -> str:
    """Return which devices can be felt now."""
    real = [row["name"] for row in rows if row["units"]]
    simulated = [row["name"] for row in rows if row["simulated"]]
    text = f"{listing(real)} {'is' if len(real) == 1 else 'are'} connected" if real else "No real device is connected"
    return f"{text}; {listing(simulated)} need none." if simulated else f"{text}."


def doctor_summary(name: str | None, verdicts: Sequence[str]) -> str:
    """Return the number of problems that keep a device, or any device, from working."""
    failed, unasked = verdicts.count("failed"), verdicts.count("not asked")
    if failed:
        return f"{_number(failed, 'check')} failed; each has its cure below."
    text = f"Nothing was found that keeps {name or 'a device'} from working"
    return f"{text}, but {_number(unasked, 'check')} could not be made." if unasked else f"{text}."


def stress_summary(figures: Mapping[str, Any]) -> str:
    """Return the rate at which a device can be read and written, next to that of a force loop."""
    rate = f"{figures['device']} can be read and written {figures['rate_hz']:.0f} times a second"
    return f"{rate}; a force loop does so 1000 times."


def _number(count: int, noun: str) -> str:
    return f"{count} {noun}{'' if count == 1 else 's'}"
