"""A session of the page's server without its processes: jobs are done in threads of this one, nothing is felt."""

import asyncio
import threading
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image

from tangible_core.pipeline.engine.cache import Cache
from tangible_ui.feeling.feeling import Feeling
from tangible_ui.requests import find_request
from tangible_ui.state.session import Session
from tangible_ui.worker.handle import WorkerKilled
from tangible_ui.worker.jobs import JOBS
from tangible_ui.worker.messages import Event
from tangible_ui.worker.state import WorkerState
from waiting import happened

TEXT = """\
# a photograph of mine
scene: {photo: mine.png}
want: touch
depth: {use: luminance}  # bright is near
texture: {use: gabor, segments: 3}
workspace: {width_m: 0.06, relief_m: 0.004}
render: {use: penalty, stiffness_n_per_m: 400}  # soft
"""


def small_scene(folder: Path) -> Path:
    """A pipeline file of a photograph of 32 x 24 pixels."""
    noise = np.random.default_rng(0).normal(size=(24, 32)).cumsum(axis=0).cumsum(axis=1)
    grey = np.uint8(255 * (noise - noise.min()) / np.ptp(noise))
    Image.fromarray(grey).save(folder / "mine.png")
    (folder / "mine.yaml").write_text(TEXT)
    return folder / "mine.yaml"


def striped_scene(folder: Path) -> Path:
    """A pipeline file of two parts on 80 mm, and between them a stripe of 2 mm: too narrow for fingers."""
    labels = np.zeros((60, 80), np.uint8)
    labels[:, 40:] = 1
    labels[:, 40:42] = 2
    Image.fromarray(labels).save(folder / "labels.png")
    Image.fromarray(80 * labels + 20).save(folder / "mine.png")
    text = TEXT.replace("{photo: mine.png}", "{photo: mine.png, segments: labels.png, kind: photograph}").replace(
        "0.06", "0.08"
    )
    (folder / "mine.yaml").write_text(text.replace("texture: {use: gabor, segments: 3}\n", ""))
    return folder / "mine.yaml"


class InlineWorker:
    """The worker's jobs without its process; `kill` makes those that somebody waits for raise, as the real one does."""

    def __init__(self, folder: Path, hear: Any) -> None:
        self._folder, self._hear = folder, hear
        self._loop = asyncio.get_running_loop()
        self.asked: list[str] = []
        self.kills = 0
        self._waiting: set[asyncio.Future[Any]] = set()
        self._start()

    def _start(self) -> None:
        alive = self._alive = threading.Event()
        alive.set()

        def tell(event: str, **told: Any) -> None:
            self._loop.call_soon_threadsafe(lambda: alive.is_set() and self._hear(Event(event, told)))

        self.state = WorkerState(self._folder, tell, Cache(self._folder / "cache"))
        self._long = asyncio.Lock()

    async def ask(self, job: str, **told: Any) -> Any:
        self.asked.append(job)
        future = asyncio.ensure_future(self._do(job, told))
        self._waiting.add(future)
        try:
            return await future
        except asyncio.CancelledError as error:
            raise WorkerKilled("killed") from error
        finally:
            self._waiting.discard(future)

    async def quick(self, job: str, **told: Any) -> Any:
        try:
            return await self.ask(job, **told)
        except WorkerKilled:
            return await self.ask(job, **told)

    async def _do(self, job: str, told: dict[str, Any]) -> Any:
        done = partial(_done, self.state, self._alive, job, told)
        if JOBS[job].quick:
            return await asyncio.to_thread(done)
        async with self._long:
            return await asyncio.to_thread(done)

    def kill(self) -> None:
        self.kills += 1
        self._alive.clear()
        for each in self._waiting:
            each.cancel()
        self._start()

    def close(self) -> None:
        self.kill()


def _done(worker_state: WorkerState, alive: threading.Event, job: str, told: dict[str, Any]) -> Any:
    """Do a job and return its result; remove the file of a job that was killed meanwhile."""
    made = JOBS[job].do(worker_state, **told)
    if not alive.is_set() and isinstance(made, dict) and "parcel" in made:
        Path(made["parcel"]).unlink()
    return made


class Heard:
    """A tab that keeps its events."""

    def __init__(self) -> None:
        self.events: list[dict[str, Any]] = []

    def say(self, event: dict[str, Any]) -> None:
        self.events.append(event)

    def last(self, name: str) -> dict[str, Any]:
        return next(event for event in reversed(self.events) if event["event"] == name)

    def names(self) -> list[str]:
        return [event["event"] for event in self.events]

    async def until(self, name: str, count: int = 1) -> dict[str, Any]:
        """Return the newest event of a name, as soon as there are `count` of them."""
        await happened(lambda: self.names().count(name) >= count, f"no {name}")
        return self.last(name)


class SmallSession:
    """A session with a tab, whose touches are kept in `felt`."""

    def __init__(self, folder: Path, monkeypatch: Any) -> None:
        monkeypatch.setattr("tangible_ui.state.session.Worker", InlineWorker)
        (folder / "drawn").mkdir()
        self.session = Session(folder / "drawn", Feeling("test"), [])
        self.worker: Any = self.session.worker
        self.tab = Heard()
        self.session.tabs.open.append(self.tab)
        self.felt: list[dict[str, Any]] = []
        monkeypatch.setattr(Session, "feel", self._feel)
        monkeypatch.setattr(Session, "feel_on", self._feel)

    async def _feel(self, made: dict[str, Any]) -> None:
        Path(made["parcel"]).unlink()
        self.felt.append(made)
        self.session.tabs.tell("touch", law=made["law"], seconds=0.0, how="")

    async def ask(self, name: str, **told: Any) -> Any:
        """Send a request of the tab."""
        return await find_request(name)(self.session, self.tab, **told)
