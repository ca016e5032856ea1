"""Requests about recordings: record, and replay with another law."""

import asyncio
from datetime import datetime
from pathlib import Path
from typing import Any

from tangible_core.errors import ConfigError, DeviceError
from tangible_core.files import as_path
from tangible_core.session import About, names_in

from ..feeling.recorder import Recorder
from ..state.session import Session
from ..state.tabs import Tab
from ..user_data import RECORDINGS, user_folder
from .table import request


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
