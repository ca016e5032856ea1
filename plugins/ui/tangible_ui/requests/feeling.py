"""Requests about the hand and the force loop: hold, stop, beacons, and two force laws compared."""

import asyncio
import json
from datetime import datetime
from pathlib import Path
from typing import Any

from tangible_core.errors import ConfigError, DeviceError
from tangible_core.files.writing import write_text
from tangible_core.servo import Beacon, parcel
from tangible_core.session import part_label

from ..feeling.feeling import LoopInput
from ..state.laws import Choice, Tally
from ..state.session import Session, Tab
from ..user_data import user_folder
from .making import make
from .table import request


@request()
async def hold(session: Session, tab: Tab) -> None:
    """Give the hand to this tab."""
    session.hold(tab)


@request()
async def stop(session: Session, tab: Tab | None) -> None:
    """Take all force away at once, until `feel`, whatever else is made meanwhile."""
    wait_until_gone = session.feeling.cut()  # before any wait
    session.tell("loop", running=False, why="stopped", stopped=True)
    session.begin(asyncio.to_thread(wait_until_gone))


@request()
async def feel(session: Session, tab: Tab) -> None:
    """Make and feel the document, also after a stop. Raises: DeviceError if its device cannot be opened."""
    session.feeling.allow()
    await make(session, tab)


@request()
async def beacon(session: Session, tab: Tab | None, part: int | None) -> dict[str, Any]:
    """Pull the hand to the part of this number; release it without a number. All tabs get every change.

    Raises: DeviceError if no loop runs, ConfigError if there is no such part.
    """
    if part is None:
        await asyncio.to_thread(session.feeling.pull_to, None)
        return _tell(session, None, "")
    if not session.feeling.running:
        raise DeviceError("nothing is felt, so nothing can be pulled; make and feel a surface first")
    made = await session.worker.quick("beacon", **session.document(session.felt_sets()), part=part)
    found: Beacon = await asyncio.to_thread(parcel.unpack, Path(made["parcel"]))
    await asyncio.to_thread(session.feeling.pull_to, found)
    return _tell(session, found.part, part_label(found.part, found.name))


def _tell(session: Session, part: int | None, name: str) -> dict[str, Any]:
    session.tell("beacon", part=part, name=name, why="asked")
    return {"part": part, "name": name}


NAMES = ("a", "b")
MOST_QUESTION = 200


@request()
async def compare_laws(session: Session, tab: Tab | None, use: str, options: str = "") -> None:
    """Compare another law with the document's, on the same surface and hand; the document's acts first.

    options: of the other law, in YAML. Raises: ConfigError for an invalid law.
    """
    other = await session.worker.quick("law_block", use=use, options=options)
    await _feel(session, 0, other)


@request()
async def switch_law(session: Session, tab: Tab | None, to: str) -> None:
    """Use `a`, the document's law, or `b`; the page shows the force of the other one."""
    if session.laws.other is None or to not in NAMES:
        raise ConfigError("there is no other law yet; choose one to compare with")
    await _feel(session, NAMES.index(to))


@request()
async def end_laws(session: Session, tab: Tab | None) -> None:
    """End the comparison, and use the document's law."""
    if session.laws.other is not None and session.laws.felt != 0:
        await _feel(session, 0)
    session.laws.alone()
    await asyncio.to_thread(session.laws.comparison.close)
    session.tell("laws", **session.laws.message())


@request()
async def begin_blind(session: Session, tab: Tab | None, question: str = "") -> None:
    """Begin a blind comparison of both laws. Raises: ConfigError if there is no second law."""
    if session.laws.other is None:
        raise ConfigError("there is no other law yet; choose one to compare with")
    session.laws.tally = tally = Tally(session.laws.named, question[:MOST_QUESTION])
    tally.draw()
    await feel_blind(session, tab, 1)


@request()
async def feel_blind(session: Session, tab: Tab | None, called: int) -> None:
    """Use the law that is named 1, or 2, in this trial."""
    tally = _tally(session)
    session.laws.called = 2 if called == 2 else 1
    await _feel(session, tally.law(session.laws.called))


@request()
async def choose_blind(session: Session, tab: Tab | None, choice: Choice) -> None:
    """Count a choice, 0 for neither, and begin the next trial."""
    tally = _tally(session)
    tally.choose(choice if choice in (1, 2) else 0)
    await feel_blind(session, tab, 1)


@request()
async def end_blind(session: Session, tab: Tab | None) -> dict[str, Any]:
    """End the blind comparison: return its results, and write them to a file of the user's."""
    tally = _tally(session)
    found = tally.as_data()
    session.laws.tally = None
    if tally.trials:
        path = user_folder("comparisons") / f"{datetime.now():%Y-%m-%d %H.%M.%S} {' and '.join(tally.laws)}.json"
        text = json.dumps({**found, "document": session.text}, indent=2) + "\n"
        await asyncio.to_thread(write_text, path, text, private=True)
        found["path"] = str(path)
    await _feel(session, 0)
    return found


def _tally(session: Session) -> Tally:
    if session.laws.tally is None:
        raise ConfigError("no blind comparison is running; begin one")
    return session.laws.tally


async def _feel(session: Session, which: int, other: dict[str, Any] | None = None) -> None:
    """Use one of the two laws; compute the other one in the background, unless the comparison is blind.

    other: a new second law.
    Raises: DeviceError if no loop runs, ConfigError for an invalid law, NotConfirmed for a motor that nobody
    agreed to; the law before stays.
    """
    laws, feeling = session.laws, session.feeling
    if not feeling.running:
        raise DeviceError("nothing is felt; make and feel a surface first")
    blocks = [other or laws.other]
    made = await session.worker.ask("laws", **session.document(session.felt_sets()), others=blocks)
    felt, shown = (LoopInput.of(made[i], feeling.channel) for i in (which, 1 - which))
    try:
        if await session.put(felt) is None:
            raise DeviceError("nothing is felt: force was stopped, or another device was chosen meanwhile")
        laws.other, laws.felt, laws.named = other or laws.other, which, _told_apart(made[0]["law"], made[1]["law"])
        if laws.tally is None:
            await asyncio.to_thread(laws.comparison.feel, shown.touch, shown.safety)
        else:
            await asyncio.to_thread(laws.comparison.close)
    finally:
        shown.touch.discard()
    session.tell("laws", **laws.message())


def _told_apart(one: str, two: str) -> tuple[str, str]:
    """Return names of both laws that differ, also if they are one law with different options."""
    return (one, two) if one != two else (f"{one} (a)", f"{two} (b)")
