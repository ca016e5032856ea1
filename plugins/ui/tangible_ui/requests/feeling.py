"""Requests about the hand and the force loop: hold, stop, beacons, two force laws compared, and recordings."""

import asyncio
from datetime import datetime
from pathlib import Path
from typing import Any, Literal

from tangible_core.errors import ConfigError, DeviceError
from tangible_core.files import as_path
from tangible_core.servo import Beacon, parcel
from tangible_core.session import About, names_in, part_label

from ..feeling.feeling import LoopInput
from ..feeling.recorder import Recorder
from ..state.session import Session
from ..state.tabs import Tab
from ..user_data import RECORDINGS, user_folder
from .making import make
from .table import request


@request()
async def hold(session: Session, tab: Tab) -> None:
    """Give the hand to this tab."""
    session.tabs.hold(tab)


@request()
async def stop(session: Session, tab: Tab | None) -> None:
    """Take all force away at once, until `feel`, whatever else is made meanwhile."""
    wait_until_gone = session.feeling.cut()  # before any wait
    session.tabs.tell("loop", running=False, why="stopped", stopped=True)
    session.begin(asyncio.to_thread(wait_until_gone))


@request()
async def feel(session: Session, tab: Tab) -> None:
    """Make and feel the document, also after a stop. Raises: DeviceError if its device cannot be opened."""
    session.feeling.allow()
    await make(session, tab)


@request()
async def beacon(session: Session, tab: Tab | None, part: int | None) -> dict[str, Any]:
    """Pull the hand to the part of this number, or release it. Raises: DeviceError without a loop, ConfigError."""
    if part is None:
        await asyncio.to_thread(session.feeling.pull_to, None)
        return _tell(session, None, "")
    if not session.feeling.running:
        raise DeviceError("nothing is felt, so nothing can be pulled; make and feel a surface first")
    packed_beacon = await session.worker.quick("beacon", **session.document.arguments(session.felt_sets()), part=part)
    target: Beacon = await asyncio.to_thread(parcel.unpack, Path(packed_beacon["parcel"]))
    await asyncio.to_thread(session.feeling.pull_to, target)
    return _tell(session, target.part, part_label(target.part, target.name))


def _tell(session: Session, part: int | None, name: str) -> dict[str, Any]:
    session.tabs.tell("beacon", part=part, name=name, why="asked")
    return {"part": part, "name": name}


NAMES = ("a", "b")
NO_OTHER = "there is no other law yet; choose one to compare with"
# What a study asks of two laws: which of three is not the same as the others, or which of two is more so.
StudyQuestion = Literal["same", "rougher", "higher"]


@request()
async def compare_laws(session: Session, tab: Tab | None, use: str, options: str = "") -> None:
    """Compare another law, with options in YAML, on the same surface; the document's acts first."""
    other = await session.worker.quick("law_block", use=use, options=options)
    await _feel(session, 0, other)


@request()
async def switch_law(session: Session, tab: Tab | None, to: str) -> None:
    """Use `a`, the document's law, or `b`; the page shows the force of the other one."""
    if session.laws.other is None or to not in NAMES:
        raise ConfigError(NO_OTHER)
    await _feel(session, NAMES.index(to))


@request()
async def end_laws(session: Session, tab: Tab | None) -> None:
    """End the comparison, and use the document's law."""
    if session.laws.other is not None and session.laws.acting != 0:
        await _feel(session, 0)
    session.laws.alone()
    await asyncio.to_thread(session.laws.comparison.close)
    session.tabs.tell("laws", **session.laws.message())


@request()
async def study_laws(
    session: Session, tab: Tab | None, question: StudyQuestion, language: Literal["en", "de"] = "en"
) -> dict[str, str]:
    """Write a blind study of both laws; return paths and command lines. Raises: ConfigError without a second law."""
    if session.laws.other is None:
        raise ConfigError(NO_OTHER)
    arguments = {"other": session.laws.other, "names": session.laws.names, "question": question, "language": language}
    return await session.worker.quick("write_law_study", **session.document.arguments(), **arguments)


async def _feel(session: Session, which: int, other: dict[str, Any] | None = None) -> None:
    """Use one of the two laws, and compute the other one in the background; after an error, the law before stays."""
    laws, feeling = session.laws, session.feeling
    if not feeling.running:
        raise DeviceError("nothing is felt; make and feel a surface first")
    blocks = [other or laws.other]
    inputs = await session.worker.ask("laws", **session.document.arguments(session.felt_sets()), others=blocks)
    acting, beside = (LoopInput.of(inputs[i], feeling.channel) for i in (which, 1 - which))
    try:
        if await session.put(acting) is None:
            raise DeviceError("nothing is felt: force was stopped, or another device was chosen meanwhile")
        laws.other, laws.acting = other or laws.other, which
        one, two = inputs[0]["law"], inputs[1]["law"]  # one law with different options gets two names too
        laws.names = (one, two) if one != two else (f"{one} (a)", f"{two} (b)")
        await asyncio.to_thread(laws.comparison.feel, beside.touch, beside.safety)
    finally:
        beside.touch.discard()
    session.tabs.tell("laws", **laws.message())


@request()
async def record(session: Session, tab: Tab | None) -> str:
    """Record the loop from now on into a new file of the user's. Raises: DeviceError if no loop runs."""
    servo, loop_input = session.feeling.servo, session.feeling.loop_input
    if servo is None or not servo.running or loop_input is None:
        raise DeviceError("nothing is felt, so there is nothing to record; make and feel a surface first")
    if session.recorder is not None and session.recorder.recording:
        raise ConfigError(f"{session.recorder.path}: is being recorded already; stop that first")
    now = datetime.now()  # the user's own clock: people look for files by it
    path = user_folder(RECORDINGS) / f"{now:%Y-%m-%d %H.%M.%S} {loop_input.law}.nc"
    loop = asyncio.get_running_loop()

    def notify_end(path: Path, ticks: int, why: str) -> None:
        message = {"recording": False, "path": str(path), "ticks": ticks, "why": why}
        loop.call_soon_threadsafe(lambda: session.tabs.tell("recorder", **message))

    text = session.document.text
    parts = await asyncio.to_thread(names_in, text)
    about = About(loop_input.device_name, loop_input.law, text, parts=parts, materials=loop_input.materials)
    session.recorder = await asyncio.to_thread(Recorder, servo, path, about, notify_end)
    session.tabs.tell("recorder", recording=True, path=str(path), ticks=0, why="")
    return str(path)


@request()
async def stop_recording(session: Session, tab: Tab | None) -> None:
    """End the recording, and close its file."""
    if session.recorder is not None:
        await asyncio.to_thread(session.recorder.stop)


@request()
async def try_law(session: Session, tab: Tab | None, record: str) -> dict[str, Any]:
    """Replay a recording with the document's force law: write the result as a recording, and compare both."""
    document = session.document.arguments(session.felt_sets())
    return await session.worker.ask("try_law", **document, record=as_path(record))
