"""Requests about devices: which there are, which one is used, what it reaches, how its loop runs."""

import asyncio
from typing import Any

from tangible_core.errors import ConfigError, DeviceError

from ..feeling.choice import Choice
from ..feeling.doctor import figures
from ..state.session import Session, Tab
from .making import make
from .table import request

FIRST_PAUSE_S, LONGEST_PAUSE_S = 1.0, 8.0
"""Before a device is looked for again; twice as long each time: to look for one starts a process."""
KINDS = ("hand", "document", "other")


@request()
async def devices(session: Session, tab: Tab | None) -> dict[str, Any]:
    """Every installed device, and which one is chosen; none is opened."""
    return {"devices": await session.worker.ask("devices"), "kind": session.choice.kind, "name": session.choice.name}


@request()
async def examine(session: Session, tab: Tab | None, name: str) -> list[dict[str, Any]]:
    """What keeps a device from working, and the cure."""
    return await session.worker.ask("examine", name=name)


@request()
async def about_device(session: Session, tab: Tab | None, kind: str, name: str = "") -> dict[str, Any]:
    """What it means to feel with this device: whether it has a motor, and how strong that may be."""
    return await _about(session, _choice(kind, name, sure=False))


@request()
async def choose_device(session: Session, tab: Tab | None, kind: str, name: str = "", sure: bool = False) -> None:
    """Feel with the page's own hand ("hand"), the document's device ("document"), or another one by its name ("other");
    also after a stop.

    sure: that the person was told that it has a motor, and said yes; it is not opened without.
    Raises: NotConfirmed, DeviceError if it cannot be opened.
    """
    choice = _choice(kind, name, sure)
    about = await _about(session, choice)
    if not about["simulated"] and not sure:
        raise ConfigError(f"{about['name']} has a motor: say yes to that first")
    session.choice = choice
    session.tell("device", kind=choice.kind, name=about["name"])
    session.feeling.allow()
    await make(session, tab)


@request()
async def wait_for_device(session: Session, tab: Tab | None) -> None:
    """Look for the chosen device again and again, until it is felt, or another one is chosen, or stop is pressed."""
    session.begin(_wait(session))


@request()
async def doctor(session: Session, tab: Tab | None) -> dict[str, Any] | None:
    """How the loop is; None where none runs."""
    servo = session.feeling.servo
    return figures(servo) if servo is not None and session.feeling.running else None


def _choice(kind: str, name: str, sure: bool) -> Choice:
    if kind not in KINDS or (kind == "other") != bool(name):
        raise ConfigError(f"a device is chosen as one of {', '.join(KINDS)}, the last one with a name")
    return Choice(kind, name, sure)


async def _about(session: Session, choice: Choice) -> dict[str, Any]:
    sets = [*session.sets, *choice.sets(session.feeling.own_device)]
    return await session.worker.ask("about_device", text=session.text, path=session.path, sets=sets)


async def _wait(session: Session) -> None:
    choice, pause_s, told = session.choice, FIRST_PAUSE_S, None
    while session.choice is choice and not session.feeling.stopped and not session.feeling.running:
        try:
            await make(session, None)
        except DeviceError as error:
            if str(error) != told:
                told = str(error)
                session.tell("loop", running=False, why=told, lost=True, waiting=True)
            await asyncio.sleep(pause_s)
            pause_s = min(2 * pause_s, LONGEST_PAUSE_S)


@request()
async def reach(session: Session, tab: Tab) -> dict[str, Any]:
    """What the document's device reaches: its name, and its workspace in metres, or none."""
    return await session.worker.quick("reach", text=session.text, path=session.path, sets=session.sets)


@request()
async def limits(session: Session, tab: Tab) -> dict[str, Any] | None:
    """Ticks since the loop began, and those in which each limit acted; none before there is a loop."""
    servo = session.feeling.servo
    if servo is None:
        return None
    report = await asyncio.to_thread(servo.report)
    return {"ticks": report.ticks, "overruns": report.overruns, "flagged": dict(report.flagged)}
