"""The session that all tabs share: the document, running jobs, the force loop, the tabs."""

import asyncio
import math
from collections.abc import Awaitable, Callable, Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar, final

from tangible_core.errors import DeviceError
from tangible_web.live import describe_error
from tangible_web.state_frame import ALONE, OtherLaw

from ..feeling.choice import Choice, NotConfirmed
from ..feeling.comparison import ComparisonLoop
from ..feeling.feeling import Feeling, LoopInput
from ..feeling.recorder import Recorder
from ..user_data import user_folder
from ..worker import Worker
from .document import Document
from .tabs import Tabs
from .uploads import UploadStore

# Pause between two drawings while a height is dragged, s: a browser draws once while the hand feels five heights.
DRAWN_PAUSE_S = 0.4


T = TypeVar("T")


@dataclass
class Laws:
    """The document's law and a second one; without a comparison, the document's alone."""

    comparison: ComparisonLoop
    other: dict[str, Any] | None = None  # the second law, as `render:` has it
    names: tuple[str, str] = ("", "")
    acting: int = 0  # index of the law that acts

    def alone(self) -> None:
        """End the comparison."""
        self.other, self.acting = None, 0

    def follow(self, feeling: Feeling) -> None:
        """Move the hand of the second law's loop to that of the first. Meant to be polled; returns at once."""
        servo = feeling.servo
        if not self.comparison.running or servo is None or (row := servo.ring.latest()) is None:
            return
        x, y, z = row[2:5].tolist()
        self.comparison.follow((x, y, z if feeling.running else math.inf))

    def other_law(self) -> OtherLaw:
        """Return what frames show of the second law."""
        return ALONE if self.other is None else OtherLaw(self.comparison.force_n)

    def message(self) -> dict[str, Any]:
        """Return the message `laws`: what pages may know."""
        if self.other is None:
            return {"state": "one"}
        return {"state": "two", "named": list(self.names), "felt": self.acting}


@final
class LongJobs:
    """Numbers of long jobs: a newer one replaces those before it."""

    def __init__(self) -> None:
        self.newest: int = 0
        self.running: set[int] = set()
        """Numbers of the jobs that somebody waits for."""
        self.apply_after: bool = False
        """True if edits came during the running job: when it ends, apply them unless something slow has to run."""
        self.was_killed: bool = False
        """True if the worker was killed for an earlier job: if the newest job died with it, it is requested again."""

    def begin(self) -> int:
        """Return the number of a new job."""
        self.newest += 1
        self.running.add(self.newest)
        return self.newest

    def stop(self) -> None:
        """Mark all running jobs as unwanted."""
        self.newest += 1
        self.was_killed, self.apply_after = True, False


@final
class LatestWins:
    """A queue of one: the running call is finished, and of those that wait the newest alone is run."""

    def __init__(self, pause_s: float = 0.0) -> None:
        """pause_s: after each call, for others; the first call after a longer rest starts at once."""
        self._pause_s = pause_s
        self._busy = False
        self._turn: asyncio.Future[bool] | None = None
        """Resolved for the call that waits: True once it may run, False once a newer call came."""

    async def run(self, work: Callable[[], Awaitable[T]]) -> T | None:
        """Run the call once the running one has ended; None as soon as a newer call comes before that."""
        self._resolve(False)
        loop = asyncio.get_running_loop()
        if self._busy:
            self._turn = turn = loop.create_future()
            if not await turn:
                return None
        self._busy = True
        try:
            return await work()
        finally:
            loop.call_later(self._pause_s, self._end)

    def _end(self) -> None:
        self._busy = self._resolve(True)

    def _resolve(self, is_next: bool) -> bool:
        """Tell the call that waits; return True if there is one."""
        turn, self._turn = self._turn, None
        if turn is None or turn.done():
            return False
        turn.set_result(is_next)
        return True


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
        self.drawings: LatestWins = LatestWins(DRAWN_PAUSE_S)
        """Requests for other heights of parts: to feel them, and to draw them."""
        self.choice: Choice = Choice()
        self.uploads: UploadStore = UploadStore(user_folder("opened"), folder / "incoming")
        self.recorder: Recorder | None = None
        """The last recording, or the running one."""
        self.fetch: asyncio.Future[asyncio.subprocess.Process] | None = None
        """The process that fetches networks, from its start to its end."""
        self.laws: Laws = Laws(ComparisonLoop(f"{feeling.channel}-beside"))
        self.panel_folders: dict[str, Path] = {}
        """Folders of the ES modules of plugins' panels, by name of the panel."""
        self.worker: Worker = Worker(folder, lambda event: self.tabs.tell(event.event, **event.payload))
        self._tasks: set[asyncio.Task[Any]] = set()

    def felt_sets(self) -> list[str]:
        """Return the changes to the document for the loop: the page's own hand, unless a device was chosen."""
        return [*self.document.sets, *self.choice.sets(self.feeling.own_device)]

    async def feel(self, loop_input: dict[str, Any]) -> None:
        """Put a made touch under the hand, and end a comparison of laws. Raises: as `put`."""
        touch = LoopInput.of(loop_input, self.feeling.channel)
        seconds = await self.put(touch)
        if seconds is not None:
            self.laws.alone()
            self.tabs.tell("laws", **self.laws.message())
            await asyncio.to_thread(self.laws.comparison.close)
            self.tabs.tell("touch", law=touch.law, seconds=seconds, how=self.feeling.how)
            self.tabs.tell("loop", running=True, why="", device=touch.device_name, own_hand=touch.own_hand)

    async def feel_on(self, loop_input: dict[str, Any]) -> None:
        """Put a touch under the hand without an announcement: dragging makes many in a second. Raises: as `put`."""
        if self.laws.other is not None or not self.feeling.running:
            await self.feel(loop_input)
        else:
            await self.put(LoopInput.of(loop_input, self.feeling.channel))

    async def put(self, touch: LoopInput) -> float | None:
        """Put a touch under the hand; return the seconds, None if too late. Raises: NotConfirmed, DeviceError."""
        try:
            self.choice.check(touch.unmapped_device)
        except NotConfirmed:
            touch.touch.discard()
            raise
        if touch.own_hand != (self.choice.kind == "hand"):
            touch.touch.discard()
            return None
        try:
            return await asyncio.to_thread(self.feeling.feel, touch)
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
