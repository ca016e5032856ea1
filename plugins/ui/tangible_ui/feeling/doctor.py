"""Figures of the force loop, which the page shows four times a second."""

from typing import Any

import numpy as np

from tangible_core.data import TICK_COLUMNS
from tangible_core.servo import Servo
from tangible_web.framing import BUTTON_BITS

LOOKED_BACK_S = 1.0
LATE_US = 200
"""Delay from which a tick counts as late, µs; it can then be felt."""
LATE_S, BUTTONS = TICK_COLUMNS.index("late_s"), TICK_COLUMNS.index("buttons")


def figures(servo: Servo) -> dict[str, Any]:
    """Return figures of the last second (rate, lateness, force, place, buttons) and of the whole loop."""
    report, ring = servo.report(), servo.ring
    rows, _ = ring.since(ring.count - round(LOOKED_BACK_S / 0.001))
    late_us = 1e6 * rows[:, LATE_S]
    span_s = rows[-1, 0] - rows[0, 0] if len(rows) > 1 else 0.0
    whole, ticks = report.late_us, max(1, int(ring.late.sum()))
    return {
        "rate_hz": (len(rows) - 1) / span_s if span_s > 0 else 0.0,
        "late_us": _spread(late_us),
        "late_share": float((late_us > LATE_US).mean()) if len(rows) else 0.0,
        "force_n": float(np.linalg.norm(report.force)),
        "most_force_n": float(report.peak_force_n),
        "position_m": list(report.state.position_m),
        "buttons": int(rows[-1, BUTTONS]) & (1 << BUTTON_BITS) - 1 if len(rows) else 0,
        "ticks": report.ticks,
        "whole_late_us": None if whole is None else {"p50": whole.p50, "p99": whole.p99, "most": whole.most},
        "whole_late_share": float(ring.late[LATE_US + 1 :].sum()) / ticks,
        "overruns": report.overruns,
        "flagged": dict(report.flagged),
        "how": servo.how,
    }


def _spread(late_us: np.ndarray) -> dict[str, float] | None:
    if not len(late_us):
        return None
    p50, p99, most = np.quantile(late_us, (0.5, 0.99, 1.0)).tolist()
    return {"p50": p50, "p99": p99, "most": most}
