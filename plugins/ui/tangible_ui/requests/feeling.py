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

from ..feeling.feeling import Felt
from ..state.laws import Choice, Tally
from ..state.session import Desk, Tab
from ..state.uploads import user_folder
from .making import make
from .table import request


@request()
async def hold(desk: Desk, tab: Tab) -> None:
    """This tab's hand is felt from now on."""
    desk.hold(tab)


@request()
async def stop(desk: Desk, tab: Tab | None) -> None:
    """No force, at once, and none until `feel`, whatever else is made meanwhile."""
    ended = desk.feeling.cut()  # before anything is waited for
    desk.tell("loop", running=False, why="stopped", stopped=True)
    desk.begin(asyncio.to_thread(ended))


@request()
async def feel(desk: Desk, tab: Tab) -> None:
    """Feel the document, also after a stop. Raises: DeviceError if its device cannot be opened."""
    desk.feeling.allow()
    await make(desk, tab)


@request()
async def beacon(desk: Desk, tab: Tab | None, part: int | None) -> dict[str, Any]:
    """Pull the hand to the part of this number from now on; to none without a number. Pages hear of every change.

    Raises: DeviceError if nothing is felt, ConfigError if there is no such part.
    """
    if part is None:
        await asyncio.to_thread(desk.feeling.pull_to, None)
        return _tell(desk, None, "")
    if not desk.feeling.running:
        raise DeviceError("nothing is felt, so nothing can be pulled; make and feel a surface first")
    document = {"text": desk.text, "path": desk.path, "sets": desk.felt_sets()}
    made = await desk.maker.quick("beacon", **document, part=part)
    found: Beacon = await asyncio.to_thread(parcel.unpack, Path(made["parcel"]))
    await asyncio.to_thread(desk.feeling.pull_to, found)
    return _tell(desk, found.part, part_label(found.part, found.name))


def _tell(desk: Desk, part: int | None, name: str) -> dict[str, Any]:
    desk.tell("beacon", part=part, name=name, why="asked")
    return {"part": part, "name": name}


NAMES = ("a", "b")
MOST_QUESTION = 200


@request()
async def law_names(desk: Desk, tab: Tab | None) -> list[str]:
    """The laws that there are to compare with."""
    return await desk.maker.quick("law_names")


@request()
async def compare_laws(desk: Desk, tab: Tab | None, use: str, options: str = "") -> None:
    """Hold another law against the document's, on the same surface and hand; the document's is felt first.

    options: of the other law, in YAML. Raises: ConfigError for what is no law.
    """
    other = await desk.maker.quick("law_block", use=use, options=options)
    await _feel(desk, 0, other)


@request()
async def switch_law(desk: Desk, tab: Tab | None, to: str) -> None:
    """Feel `a`, the document's law, or `b`; the other one's force is shown."""
    if desk.laws.other is None or to not in NAMES:
        raise ConfigError("there is no other law yet; choose one to compare with")
    await _feel(desk, NAMES.index(to))


@request()
async def end_laws(desk: Desk, tab: Tab | None) -> None:
    """One law again: the document's."""
    if desk.laws.other is not None and desk.laws.felt != 0:
        await _feel(desk, 0)
    desk.laws.alone()
    await asyncio.to_thread(desk.laws.rival.close)
    desk.tell("laws", **desk.laws.told())


@request()
async def begin_blind(desk: Desk, tab: Tab | None, question: str = "") -> None:
    """Compare both without knowing which is which. Raises: ConfigError if there is no other law."""
    if desk.laws.other is None:
        raise ConfigError("there is no other law yet; choose one to compare with")
    desk.laws.tally = tally = Tally(desk.laws.named, question[:MOST_QUESTION])
    tally.draw()
    await feel_blind(desk, tab, 1)


@request()
async def feel_blind(desk: Desk, tab: Tab | None, called: int) -> None:
    """Feel the law that is called 1, or 2, in this trial."""
    tally = _tally(desk)
    desk.laws.called = 2 if called == 2 else 1
    await _feel(desk, tally.law(desk.laws.called))


@request()
async def choose_blind(desk: Desk, tab: Tab | None, choice: Choice) -> None:
    """Count a choice, 0 for neither, and begin the next trial."""
    tally = _tally(desk)
    tally.choose(choice if choice in (1, 2) else 0)
    await feel_blind(desk, tab, 1)


@request()
async def end_blind(desk: Desk, tab: Tab | None) -> dict[str, Any]:
    """Say which was chosen how often, and keep that in a file of the user's."""
    tally = _tally(desk)
    found = tally.told()
    desk.laws.tally = None
    if tally.trials:
        path = user_folder("comparisons") / f"{datetime.now():%Y-%m-%d %H.%M.%S} {' and '.join(tally.laws)}.json"
        await asyncio.to_thread(write_text, path, json.dumps({**found, "document": desk.text}, indent=2) + "\n")
        found["path"] = str(path)
    await _feel(desk, 0)
    return found


def _tally(desk: Desk) -> Tally:
    if desk.laws.tally is None:
        raise ConfigError("no blind comparison goes on; begin one")
    return desk.laws.tally


async def _feel(desk: Desk, which: int, other: dict[str, Any] | None = None) -> None:
    """Feel one of the two laws; the other one is computed beside, unless they are compared blindly.

    other: another law than before.
    Raises: DeviceError if nothing is felt, ConfigError if there is no such law, NotAgreed for a motor that nobody said
    yes to; what was felt before goes on.
    """
    laws, feeling = desk.laws, desk.feeling
    if not feeling.running:
        raise DeviceError("nothing is felt; make and feel a surface first")
    blocks = [other or laws.other]
    made = await desk.maker.ask("laws", text=desk.text, path=desk.path, sets=desk.felt_sets(), others=blocks)
    felt, beside = (Felt.of(made[i], feeling.channel) for i in (which, 1 - which))
    try:
        if await desk.put(felt) is None:
            raise DeviceError("nothing is felt: force was stopped, or another device was chosen meanwhile")
        laws.other, laws.felt, laws.named = other or laws.other, which, _told_apart(made[0]["law"], made[1]["law"])
        if laws.tally is None:
            await asyncio.to_thread(laws.rival.feel, beside.touch, beside.safety)
        else:
            await asyncio.to_thread(laws.rival.close)
    finally:
        beside.touch.discard()
    desk.tell("laws", **laws.told())


def _told_apart(one: str, two: str) -> tuple[str, str]:
    """Names of both, also where one law is compared with itself under other options."""
    return (one, two) if one != two else (f"{one} (a)", f"{two} (b)")
