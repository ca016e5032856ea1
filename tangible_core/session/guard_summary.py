"""A summary of the guard: one sentence if it changed most of the forces, with the cure."""

from collections.abc import Mapping

import numpy as np
from jaxtyping import Int64

from ..data import TickFlag

MOST = 0.5  # share of the ticks in contact above which a limit is reported

SENTENCES = {
    TickFlag.STIFFNESS_LIMITED: "the force was scaled down, because the force law is stiffer than this device and loop "
    "can render stably; use a lower `render.stiffness_n_per_m` or softer materials",
    TickFlag.FORCE_LIMITED: "the force exceeded the greatest allowed force and was limited to it; press less, or "
    "use a lower `workspace.relief_m` or a lower stiffness",
    TickFlag.SLEW_LIMITED: "the force was delayed, because it changed by more than `safety.max_step_n` in a tick; "
    "use a smoother or lower relief (`workspace.smooth_m`, `workspace.relief_m`) or a softer force law",
    TickFlag.DAMPED: "the hand was damped, because the force law gave it more energy than it took; use a softer force "
    "law, less texture, or `safety.coupling: auto`",
    TickFlag.NOT_FINITE: "the force was set to zero, because the force law or the device gave a value that is not a "
    "number; the force law or the driver is at fault",
    TickFlag.STALE: "the force was set to zero, because no new position came in time; check the device's "
    "connection, and whether the force law takes longer than a tick",
}


def guard_summary(flagged: Mapping[str, int]) -> str:
    """Return a sentence about the limit that changed most ticks in contact, and the cure; empty if there is none.

    flagged: number of ticks with each flag, by its name, as in `ServoReport.flagged`. Fading in is not reported.

    >>> guard_summary({"TOUCHING": 1000, "STIFFNESS_LIMITED": 499})
    ''
    """
    by_name = {flag.name or "": flag for flag in SENTENCES}
    contacts = sum(flagged.get(name, 0) for name in ("TOUCHING", "NOT_FINITE", "STALE"))  # no tick has two of these
    ticks, name = max((flagged.get(name, 0), name) for name in by_name)
    if ticks <= MOST * contacts:
        return ""
    share = f"{100 * ticks / contacts:.0f} %"
    return f"In {share} of the ticks in contact {SENTENCES[by_name[name]]} (`tangible preflight` shows what fits)."


def flag_counts(flags: Int64[np.ndarray, "n"]) -> Mapping[str, int]:
    """Count the ticks with each flag, by its name, without flags that no tick has."""
    counts = {flag.name or "": int(np.count_nonzero(flags & flag)) for flag in TickFlag}
    return {name: count for name, count in counts.items() if count}
