"""Requests about the device: describe and choose one, wait for it, how its loop runs."""

import asyncio
from typing import Any

from tangible_core.errors import ConfigError, DeviceError

from ..feeling.choice import Choice
from ..feeling.doctor import figures
from ..state.session import Session
from ..state.tabs import Tab
from .making import make
from .table import request

FIRST_PAUSE_S, LONGEST_PAUSE_S = 1.0, 8.0
"""First and longest pause before a device is looked for again, s; each doubles the last, as a look starts a process."""
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
    choice, pause_s, told = session.choice, FIRST_PAUSE_S, None
    while session.choice is choice and not session.feeling.stopped and not session.feeling.running:
        try:
            await make(session, None)
        except DeviceError as error:
            if str(error) != told:
                told = str(error)
                session.tabs.tell("loop", running=False, why=told, lost=True, waiting=True)
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
