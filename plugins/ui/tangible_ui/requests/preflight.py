"""Requests to judge the document before a hand meets it, and to correct what can be."""

from typing import Any

from tangible_core.data import TICK_COLUMNS
from tangible_core.files.yaml import json_in_yaml
from tangible_core.plugins import Medium
from tangible_core.servo import PERIOD_NS, SPINS

from ..state.session import Session
from ..state.tabs import Tab
from ..worker.messages import Late
from .document import change
from .making import long_job
from .table import request

MIN_TICKS = 1000  # minimum number of ticks of a loop whose lateness is judged


@request()
async def preflight(session: Session, tab: Tab | None) -> dict[str, Any] | None:
    """Judge the document on its device, or on the page's own hand without one; None if it was stopped."""
    return await long_job(session, "preflight", "touch", sets=session.document.sets, **_loop(session))


@request()
async def fix(session: Session, tab: Tab | None, apply: bool = False) -> dict[str, Any] | None:
    """Apply the changes that preflight proposes, and judge again; None if it was stopped."""
    result = await long_job(session, "fix", "touch", sets=session.document.sets, **_loop(session))
    if result is None:
        return None
    if result["changes"]:
        await change(session, tab, changes=result["changes"], apply=apply)
    await preflight(session, tab)
    return result


@request()
async def legible(
    session: Session, tab: Tab | None, medium: Medium, width_m: float | None = None
) -> dict[str, Any] | None:
    """Judge the document by the rules of a medium, at the width as export draws it by default; None if stopped."""
    return await long_job(session, "legible", "parts", sets=session.document.sets, medium=medium, width_m=width_m)


def _loop(session: Session) -> dict[str, Any]:
    """Return the page's own hand, and the lateness of the loop's ticks if there were enough of them."""
    own = f"device={json_in_yaml(session.feeling.own_device)}"
    servo = session.feeling.servo
    if servo is None or not session.feeling.running:
        return {"own": own, "late": None}
    rows, _ = servo.ring.since(0)
    header = servo.ring.header
    late = Late(rows[:, TICK_COLUMNS.index("late_s")], float(header[PERIOD_NS]) / 1e9, bool(header[SPINS]))
    return {"own": own, "late": late if len(rows) >= MIN_TICKS else None}
