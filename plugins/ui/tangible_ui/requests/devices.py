"""Requests about the device: describe and choose one, wait for it, how its loop runs."""

import asyncio
from typing import Any

import numpy as np

from tangible_core.data import TICK_COLUMNS
from tangible_core.errors import ConfigError, DeviceError
from tangible_core.servo import Servo
from tangible_web.framing import BUTTON_BITS

from ..feeling.choice import Choice
from ..state.session import Session
from ..state.tabs import Tab
from .making import make
from .table import request

# First and longest pause before a device is looked for again, s; each doubles the last, as a look starts a process.
FIRST_PAUSE_S, LONGEST_PAUSE_S = 1.0, 8.0
KINDS = ("hand", "document", "other")


@request()
async def about_device(session: Session, tab: Tab | None, kind: str, name: str = "") -> dict[str, Any]:
    """Describe a device before it is used: whether it has a motor, and its greatest force."""
    return await _about(session, _choice(kind, name, sure=False))


@request()
async def choose_device(session: Session, tab: Tab | None, kind: str, name: str = "", sure: bool = False) -> None:
    """Use the page's own "hand", the "document"'s device, or an "other" one. sure: the person agreed to a motor."""
    choice = _choice(kind, name, sure)
    about = await _about(session, choice)
    if not about["simulated"] and not sure:
        raise ConfigError(f"{about['name']} has a motor: agree to that first")
    session.choice = choice
    session.tabs.tell("device", kind=choice.kind, name=about["name"])
    session.feeling.allow()
    await make(session, tab)


@request()
async def wait_for_device(session: Session, tab: Tab | None) -> None:
    """Look for the chosen device until it can be used, another one is chosen, or a stop."""
    session.begin(_wait(session))


@request()
async def doctor(session: Session, tab: Tab | None) -> dict[str, Any] | None:
    """Return figures of the loop; None if none runs."""
    servo = session.feeling.servo
    return figures(servo) if servo is not None and session.feeling.running else None


def _choice(kind: str, name: str, sure: bool) -> Choice:
    if kind not in KINDS or (kind == "other") != bool(name):
        raise ConfigError(f"a device is chosen as one of {', '.join(KINDS)}, the last one with a name")
    return Choice(kind, name, sure)


async def _about(session: Session, choice: Choice) -> dict[str, Any]:
    sets = [*session.document.sets, *choice.sets(session.feeling.own_device)]
    return await session.worker.ask("about_device", **session.document.arguments(sets))


async def _wait(session: Session) -> None:
    choice, pause_s, last_error = session.choice, FIRST_PAUSE_S, None
    while session.choice is choice and not session.feeling.is_stopped and not session.feeling.running:
        try:
            await make(session, None)
        except DeviceError as error:
            if str(error) != last_error:
                last_error = str(error)
                session.tabs.tell("loop", running=False, why=last_error, lost=True, waiting=True)
            await asyncio.sleep(pause_s)
            pause_s = min(2 * pause_s, LONGEST_PAUSE_S)


@request()
async def limits(session: Session, tab: Tab) -> dict[str, Any] | None:
    """Return the number of ticks since the loop began, and of those in which each limit acted; None before a loop."""
    servo = session.feeling.servo
    if servo is None:
        return None
    report = await asyncio.to_thread(servo.report)
    return {"ticks": report.ticks, "overruns": report.overruns, "flagged": dict(report.flagged)}


LOOKED_BACK_S = 1.0
LATE_US = 200  # delay from which a tick counts as late, µs; it can then be felt
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
