"""The session that all tabs share: the document, running jobs, the force loop, the tabs."""

import asyncio
from collections.abc import Iterable
from pathlib import Path
from typing import Any, final

from tangible_core.errors import DeviceError
from tangible_web.live import describe_error

from ..feeling.choice import Choice, NotConfirmed
from ..feeling.comparison import ComparisonLoop
from ..feeling.feeling import Feeling, LoopInput
from ..feeling.recorder import Recorder
from ..user_data import user_folder
from ..worker import Worker
from ..worker.messages import Event
from .document import Document
from .laws import Laws
from .scheduling import LatestWins, LongJobs
from .tabs import Tabs
from .uploads import UploadStore

DRAWN_PAUSE_S = 0.4
"""Pause between two drawings while a height is dragged, s: a browser draws once while the hand feels five heights."""


@final
class Session:
    """The state of one program; used in the event loop's thread alone."""

    def __init__(self, folder: Path, feeling: Feeling, sets: Iterable[str]) -> None:
        self.folder = folder
        self.feeling = feeling
        self.tabs: Tabs = Tabs(lambda: self.feeling.hand.release())
        self.document: Document = Document(sets)
        self.waits_for_file = False
        """True if the program was started without a file: until one is opened, pages begin with a choice."""
        self.opening: Path | None = None
        """The picture that was opened last, if a browser can show it."""
        self.long_jobs: LongJobs = LongJobs()
        self.strokes: LatestWins = LatestWins()
        """Requests for a part under a stroke."""
        self.heights: LatestWins = LatestWins()
        self.drawn: LatestWins = LatestWins(DRAWN_PAUSE_S)
        """Requests for other heights of parts: to feel them, and to draw them."""
        self.choice: Choice = Choice()
        """The chosen device."""
        self.uploads: UploadStore = UploadStore(user_folder("opened"), folder / "incoming")
        self.recorder: Recorder | None = None
        """The last recording, or the running one."""
        self.fetch: asyncio.Future[asyncio.subprocess.Process] | None = None
        """The process that fetches networks, from its start to its end."""
        self.laws: Laws = Laws(ComparisonLoop(f"{feeling.channel}-beside"))
        self.panel_folders: dict[str, Path] = {}
        """Folders of the ES modules of plugins' panels, by name of the panel."""
        self.worker: Worker = Worker(folder, self._hear)
        self._tasks: set[asyncio.Task[Any]] = set()

    def felt_sets(self) -> list[str]:
        """Return the changes to the document for the loop: the page's own hand, unless a device was chosen."""
        return [*self.document.sets, *self.choice.sets(self.feeling.own_device)]

    async def feel(self, made: dict[str, Any]) -> None:
        """Put a made touch under the hand, and end a comparison of laws. Raises: as `put`."""
        felt = LoopInput.of(made, self.feeling.channel)
        seconds = await self.put(felt)
        if seconds is not None:
            self.laws.alone()
            self.tabs.tell("laws", **self.laws.message())
            await asyncio.to_thread(self.laws.comparison.close)
            self.tabs.tell("touch", law=felt.law, seconds=seconds, how=self.feeling.how)
            self.tabs.tell("loop", running=True, why="", device=felt.device_name, own_hand=felt.own_hand)

    async def feel_on(self, made: dict[str, Any]) -> None:
        """Put a touch under the hand without an announcement: dragging makes many in a second. Raises: as `put`."""
        if self.laws.other is not None or not self.feeling.running:
            await self.feel(made)
        else:
            await self.put(LoopInput.of(made, self.feeling.channel))

    async def put(self, felt: LoopInput) -> float | None:
        """Put a touch under the hand; return the seconds, None if too late. Raises: NotConfirmed, DeviceError."""
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
                self.tabs.tell("loop", running=False, why=str(error), lost=isinstance(error, DeviceError))
            raise

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
        self.tabs.tell("error", text=await describe_error(error))

    def _hear(self, event: Event) -> None:
        self.tabs.tell(event.event, **event.told)

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
