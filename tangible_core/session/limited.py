"""Whether the guard changed most of what was felt: one plain sentence, with the cure."""

from collections.abc import Mapping

import numpy as np
from jaxtyping import Int64

from ..data import TickFlag

MOST = 0.5
"""Share of the ticks in contact from which a limit is no exception."""

SAID = {
    TickFlag.STIFFNESS_LIMITED: "the force was softened, because the law is stiffer than this device and loop hold; "
    "use a lower `render.stiffness_n_per_m` or softer materials",
    TickFlag.FORCE_LIMITED: "the force was over the greatest that is allowed and was cut down to it; press less, or "
    "use a lower `workspace.relief_m` or a lower stiffness",
    TickFlag.SLEW_LIMITED: "the force was held back, because it changed by more than `safety.max_step_n` in a tick; "
    "use a smoother or lower relief (`workspace.smooth_m`, `workspace.relief_m`) or a softer law",
    TickFlag.DAMPED: "the hand was braked, because the law gave it more energy than it took; use a softer law, less "
    "texture, or `safety.coupling: auto`",
    TickFlag.NOT_FINITE: "the force was set to zero, because the law or the device gave a value that is no number; the "
    "force law or the driver is at fault",
    TickFlag.STALE: "the force was set to zero, because no new position came in time; check the device's "
    "connection, and whether the force law takes longer than a tick",
}


def changed_most(flagged: Mapping[str, int]) -> str:
    """What the guard did to most ticks in contact, and the cure; empty where it changed fewer.

    flagged: how many ticks have each flag, by its name, as `ServoReport.flagged` has it. Fading in is not told.

    >>> changed_most({"TOUCHING": 1000, "STIFFNESS_LIMITED": 499})
    ''
    """
    by_name = {flag.name or "": flag for flag in SAID}
    touched = sum(flagged.get(name, 0) for name in ("TOUCHING", "NOT_FINITE", "STALE"))  # no tick has two of these
    ticks, name = max((flagged.get(name, 0), name) for name in by_name)
    if ticks <= MOST * touched:
        return ""
    share = f"{100 * ticks / touched:.0f} %"
    return f"In {share} of the ticks in contact {SAID[by_name[name]]} (`tangible preflight` says what fits)."


def flag_counts(flags: Int64[np.ndarray, "n"]) -> Mapping[str, int]:
    """How many ticks have each flag, by its name, those that none has left out."""
    counts = {flag.name or "": int(np.count_nonzero(flags & flag)) for flag in TickFlag}
    return {name: count for name, count in counts.items() if count}
