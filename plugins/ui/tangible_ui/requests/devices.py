"""Requests about devices: which there are, which one is used, what it reaches, how its loop runs."""

import asyncio
from typing import Any

from tangible_core.errors import ConfigError, DeviceError

from ..feeling.choice import Choice
from ..feeling.doctor import figures
from ..state.session import Desk, Tab
from .making import make
from .table import request

FIRST_PAUSE_S, LONGEST_PAUSE_S = 1.0, 8.0
"""Before a device is looked for again; twice as long each time: to look for one starts a process."""
KINDS = ("hand", "document", "other")


@request()
async def devices(desk: Desk, tab: Tab | None) -> dict[str, Any]:
    """Every installed device, and which one is chosen; none is opened."""
    return {"devices": await desk.maker.ask("devices"), "kind": desk.choice.kind, "name": desk.choice.name}


@request()
async def examine(desk: Desk, tab: Tab | None, name: str) -> list[dict[str, Any]]:
    """What keeps a device from working, and the cure."""
    return await desk.maker.ask("examine", name=name)


@request()
async def about_device(desk: Desk, tab: Tab | None, kind: str, name: str = "") -> dict[str, Any]:
    """What it means to feel with this device: whether it has a motor, and how strong that may be."""
    return await _about(desk, _choice(kind, name, sure=False))


@request()
async def choose_device(desk: Desk, tab: Tab | None, kind: str, name: str = "", sure: bool = False) -> None:
    """Feel with the page's own hand ("hand"), the document's device ("document"), or another one by its name ("other");
    also after a stop.

    sure: that the person was told that it has a motor, and said yes; it is not opened without.
    Raises: NotAgreed, DeviceError if it cannot be opened.
    """
    choice = _choice(kind, name, sure)
    about = await _about(desk, choice)
    if not about["simulated"] and not sure:
        raise ConfigError(f"{about['name']} has a motor: say yes to that first")
    desk.choice = choice
    desk.tell("device", kind=choice.kind, name=about["name"])
    desk.feeling.allow()
    await make(desk, tab)


@request()
async def wait_for_device(desk: Desk, tab: Tab | None) -> None:
    """Look for the chosen device again and again, until it is felt, or another one is chosen, or stop is pressed."""
    desk.begin(_wait(desk))


@request()
async def doctor(desk: Desk, tab: Tab | None) -> dict[str, Any] | None:
    """How the loop is; None where none runs."""
    servo = desk.feeling.servo
    return figures(servo) if servo is not None and desk.feeling.running else None


def _choice(kind: str, name: str, sure: bool) -> Choice:
    if kind not in KINDS or (kind == "other") != bool(name):
        raise ConfigError(f"a device is chosen as one of {', '.join(KINDS)}, the last one with a name")
    return Choice(kind, name, sure)


async def _about(desk: Desk, choice: Choice) -> dict[str, Any]:
    sets = [*desk.sets, *choice.sets(desk.feeling.own_device)]
    return await desk.maker.ask("about_device", text=desk.text, path=desk.path, sets=sets)


async def _wait(desk: Desk) -> None:
    choice, pause_s, told = desk.choice, FIRST_PAUSE_S, None
    while desk.choice is choice and not desk.feeling.stopped and not desk.feeling.running:
        try:
            await make(desk, None)
        except DeviceError as error:
            if str(error) != told:
                told = str(error)
                desk.tell("loop", running=False, why=told, lost=True, waiting=True)
            await asyncio.sleep(pause_s)
            pause_s = min(2 * pause_s, LONGEST_PAUSE_S)


@request()
async def reach(desk: Desk, tab: Tab) -> dict[str, Any]:
    """What the document's device reaches: its name, and its workspace in metres, or none."""
    return await desk.maker.quick("reach", text=desk.text, path=desk.path, sets=desk.sets)


@request()
async def limits(desk: Desk, tab: Tab) -> dict[str, Any] | None:
    """Ticks since the loop began, and those in which each limit acted; none before there is a loop."""
    servo = desk.feeling.servo
    if servo is None:
        return None
    report = await asyncio.to_thread(servo.report)
    return {"ticks": report.ticks, "overruns": report.overruns, "flagged": dict(report.flagged)}
