"""The session that all tabs share: the document, running jobs, the force loop, the holder of the hand, past events."""

import asyncio
import time
from collections import deque
from collections.abc import Iterable
from pathlib import Path
from typing import Any, Protocol, final, runtime_checkable

from tangible_core.errors import DeviceError
from tangible_web.live import describe_error

from ..feeling.choice import Choice, NotConfirmed
from ..feeling.comparison import ComparisonLoop
from ..feeling.feeling import Feeling, LoopInput
from ..feeling.recorder import Recorder
from ..user_data import user_folder
from ..worker import Worker
from ..worker.messages import Event
from .drafts import Drafts
from .laws import Laws
from .scheduling import LatestWins, LongJobs
from .texts import Texts
from .uploads import UploadStore

MOST_HISTORY, MOST_LOGGED = 500, 200
"""Numbers of past events and of log lines that a tab opened later gets."""
DRAWN_PAUSE_S = 0.4
"""Pause between two drawings while a height is dragged, s: a browser draws once while the hand feels five heights."""
LATEST_ONLY = frozenset(
    {"restored", "document", "plan", "materials", "preflight", "legible", "exported", "beacon", "described"}
) | {"maker", "maker_gone"}
"""Events that describe a state: only the latest of each counts, and it is kept however many other events follow."""


@runtime_checkable
class Tab(Protocol):
    """A page in a browser."""

    def say(self, event: dict[str, Any]) -> None:
        """Send an event without waiting."""


@final
class Session:
    """The state of one program; used in the event loop's thread alone."""

    def __init__(self, folder: Path, feeling: Feeling, sets: Iterable[str]) -> None:
        self.folder = folder
        self.feeling = feeling
        self.sets: list[str] = list(sets)
        """Changes from the command line, which override the file."""
        self.text: str = ""
        self.path: Path = Path.cwd() / "untitled.yaml"
        """The document: the text of a pipeline file, and its path."""
        self.digest = ""
        """Digest of the text, as events name it."""
        self.waits_for_file = False
        """True if the program was started without a file: until one is opened, pages begin with a choice."""
        self.texts: Texts = Texts()
        self.long_jobs: LongJobs = LongJobs()
        self.strokes: LatestWins = LatestWins()
        """Requests for a part under a stroke."""
        self.heights: LatestWins = LatestWins()
        self.drawn: LatestWins = LatestWins(DRAWN_PAUSE_S)
        """Requests for other heights of parts: to feel them, and to draw them."""
        self.choice: Choice = Choice()
        """The chosen device."""
        self.drafts: Drafts = Drafts(user_folder("unsaved"))
        self.uploads: UploadStore = UploadStore(user_folder("opened"), folder / "incoming")
        self.recorder: Recorder | None = None
        """The last recording, or the running one."""
        self.laws: Laws = Laws(ComparisonLoop(f"{feeling.channel}-beside"))
        self.scene: dict[str, Any] | None = None
        self.panel_folders: dict[str, Path] = {}
        """Folders of the ES modules of plugins' panels, by name of the panel."""
        self.tabs: list[Tab] = []
        self.holder: Tab | None = None
        """The tab that moves the hand."""
        self._latest: dict[str, dict[str, Any]] = {}
        """The latest event of each kind in `LATEST_ONLY`."""
        self._history: deque[dict[str, Any]] = deque(maxlen=MOST_HISTORY)
        self._logged: deque[dict[str, Any]] = deque(maxlen=MOST_LOGGED)
        self.worker: Worker = Worker(folder, self._hear)
        self.began_s: float = time.time()
        self._tasks: set[asyncio.Task[Any]] = set()

    def felt_sets(self) -> list[str]:
        """Return the changes to the document for the loop: the page's own hand, unless a device was chosen."""
        return [*self.sets, *self.choice.sets(self.feeling.own_device)]

    def document(self, sets: list[str] | None = None) -> dict[str, Any]:
        """Return the document as jobs take it. sets: changes to it; by default those of the command line."""
        return {"text": self.text, "path": self.path, "sets": self.sets if sets is None else sets}

    async def feel(self, made: dict[str, Any]) -> None:
        """Put a made touch under the hand, and end a comparison of laws. Raises: as `put`."""
        felt = LoopInput.of(made, self.feeling.channel)
        seconds = await self.put(felt)
        if seconds is not None:
            self.laws.alone()
            self.tell("laws", **self.laws.message())
            await asyncio.to_thread(self.laws.comparison.close)
            self.tell("touch", law=felt.law, seconds=seconds, how=self.feeling.how)
            self.tell("loop", running=True, why="", device=felt.device_name, own_hand=felt.own_hand)

    async def feel_on(self, made: dict[str, Any]) -> None:
        """Put a touch under the hand that hardly differs from the current one; announce it only if no loop ran.

        Dragging makes many in a second: they must not fill the history. Raises: as `put`.
        """
        if self.laws.other is not None or not self.feeling.running:
            await self.feel(made)
        else:
            await self.put(LoopInput.of(made, self.feeling.channel))

    async def put(self, felt: LoopInput) -> float | None:
        """Put a touch under the hand; return the seconds that took.

        Returns: None after a stop, or if another device was chosen meanwhile: the touch is then not used.
        Raises: NotConfirmed for a motor that nobody agreed to, DeviceError if the device cannot be opened.
        """
        try:
            self.choice.check(felt.unmapped_device)
        except NotConfirmed:
            felt.touch.discard()
            raise
        if felt.own_hand != (self.choice.kind == "hand"):
            felt.touch.discard()
            return None
        try:
            return await asyncio.to_thread(self.feeling.feel, felt)
        except Exception as error:
            if not self.feeling.running:
                self.tell("loop", running=False, why=str(error), lost=isinstance(error, DeviceError))
            raise

    def tell(self, event: str, **told: Any) -> None:
        """Send an event to all tabs, and to those opened later."""
        said = {"event": event, "at_s": round(time.time(), 3), **told}
        if event == "scene":
            self.scene = said
        elif event in LATEST_ONLY:
            self._latest[event] = said
        else:
            (self._logged if event == "log" else self._history).append(said)
        for tab in list(self.tabs):
            tab.say(said)

    @property
    def history(self) -> list[dict[str, Any]]:
        """The events that a tab opened now has missed, oldest first; however much is logged, the rest is there."""
        return sorted([*self._latest.values(), *self._history, *self._logged], key=lambda said: said["at_s"])

    def enter(self, tab: Tab) -> None:
        """Add a tab; it gets the hand if no other tab holds it."""
        self.tabs.append(tab)
        if self.holder is None:
            self.hold(tab)
        else:
            self._say_who_holds()

    def leave(self, tab: Tab) -> None:
        """Remove a tab that was closed or is gone. If it held the hand, nobody does until a tab takes it.

        No tab gets the hand unasked: a mouse may lie pressed on a page that nobody looks at.
        """
        self.tabs.remove(tab)
        if self.holder is tab:
            self.hold(None)

    def hold(self, tab: Tab | None) -> None:
        """Give the hand to this tab, or to none; the others watch."""
        self.feeling.hand.release()
        self.holder = tab
        self._say_who_holds()

    def _say_who_holds(self) -> None:
        for each in self.tabs:
            each.say({"event": "holding", "holding": each is self.holder, "free": self.holder is None})

    def begin(self, work: Any) -> None:
        """Run a coroutine in the background; its errors are sent to all tabs."""
        task = asyncio.ensure_future(work)
        self._tasks.add(task)
        task.add_done_callback(self._finish_task)

    def _finish_task(self, task: "asyncio.Task[Any]") -> None:
        self._tasks.discard(task)
        if not task.cancelled() and (error := task.exception()) is not None:
            self.report_failure(error)

    def report_failure(self, error: BaseException) -> None:
        """Send the sentence of a background error to all tabs."""
        self.begin(self._say_failure(error))

    async def _say_failure(self, error: BaseException) -> None:
        self.tell("error", text=await describe_error(error))

    def _hear(self, event: Event) -> None:
        self.tell(event.event, **event.told)

    async def close(self) -> None:
        """End force, worker and recording; a failure of one does not keep the others."""
        self.feeling.cut()
        self.worker.close()
        try:
            await asyncio.to_thread(self.feeling.stop)
        finally:
            await asyncio.to_thread(self.laws.comparison.close)
            if self.recorder is not None:
                await asyncio.to_thread(self.recorder.stop)
