"""Players, which show the reliefs of a film to a force loop: a thread in real time, or a function of simulated time."""

import logging
import statistics
import threading
import time
from collections import deque
from collections.abc import Callable
from dataclasses import replace
from typing import final

from ...data import FilmFelt, ServoReport
from ...errors import BrokenMethod, DeviceError, Stopped, TangibleError
from ...plugins.interfaces import Film
from ...runtime.stopping import stoppable
from ...runtime.system.processes import lower_priority, processors
from ...runtime.threads import limited_threads, thread_limit
from ...scene.video.capture import VideoFrame, VideoFrames
from .reliefs import FrameRelief, Reliefs

log: logging.Logger = logging.getLogger(__name__)
# Time to wait for a player to end; if it still computes then, it is abandoned.
STOPPING_S = 0.5
OPEN_AGAIN_S = 1.0
# Niceness of the thread, so that the force loop's process goes first; on systems with a niceness per thread.
NICENESS = 5
MAX_WAIT_S = 0.01  # longest time between two checks for a frame
AGES = 1000


@final
class _Screen:
    """A film with counts of shown and damaged frames; the surface stands still while frames are damaged."""

    def __init__(self, film: Film) -> None:
        self.film = film
        self._last: FrameRelief | None = None
        self._logged_kinds = set[type]()
        self.show_count = self.damage_count = 0

    def show(self, frame: FrameRelief) -> None:
        self.film.show(frame.relief, frame.number)
        self._last = frame
        self.show_count += 1

    @property
    def waits(self) -> bool:
        """True while the surface has not reached the last frame."""
        return self._last is not None and not self.film.arrived

    def repeat(self) -> None:
        """Show the last frame again, as the speed of the surface is limited."""
        if self._last is not None:
            self.film.show(self._last.relief, self._last.number)

    def skip(self, error: TangibleError) -> None:
        """Count a damaged frame, and log each kind of error once. Raises: the error if it is a plugin's fault."""
        if isinstance(error, BrokenMethod | Stopped):
            raise error
        self.damage_count += 1
        if type(error) not in self._logged_kinds:
            self._logged_kinds.add(type(error))
            log.warning("the surface stands still until the next valid frame: %s", error)

    def counts(self, skip_count: int, per_s: float, age_ms: float | None) -> FilmFelt:
        return FilmFelt(self.show_count, self.film.dropped, skip_count, self.damage_count, per_s, age_ms)


@final
class Player:
    """A thread that plays a film to a loop in real time: the latest frame wins."""

    def __init__(self, reliefs: Reliefs, film: Film, threads: int | None = None) -> None:
        """Prepare the thread. threads: greatest number of threads that work at once, as `Pipeline.threads`."""
        self._reliefs, self._screen = reliefs, _Screen(film)
        self._threads = max(1, min(threads or thread_limit() or processors(), processors() - 1))
        self._ending = threading.Event()
        self._fault: BaseException | None = None
        self._skip_count = 0
        self._began_s: float | None = None
        self._since_s = self._until_s = 0.0
        self._ages_s = deque[float](maxlen=AGES)
        self._thread = threading.Thread(target=self._run, name="film", daemon=True)

    def start(self) -> None:
        """Start with the first frame."""
        self._thread.start()

    def stop(self) -> None:
        """Stop showing frames. Returns within a second, though a slow method may work for longer."""
        self._ending.set()
        if self._thread.is_alive():
            self._thread.join(STOPPING_S)

    def check(self) -> None:
        """Raise the error of a plugin, if there was one."""
        if self._fault is not None:
            fault, self._fault = self._fault, None
            raise fault

    @property
    def counts(self) -> FilmFelt:
        """The counts of the film so far."""
        seconds = self._until_s - self._since_s
        per_s = (self._screen.show_count - 1) / seconds if seconds > 0 else 0.0
        age_ms = 1e3 * statistics.median(list(self._ages_s)) if self._ages_s else None
        return self._screen.counts(self._skip_count, per_s, age_ms)

    def _run(self) -> None:
        lower_priority({threading.get_native_id()}, NICENESS)
        try:
            with stoppable(self._ending), limited_threads(self._threads):
                while not self._ending.is_set() and not self._play():
                    self._ending.wait(OPEN_AGAIN_S)
        except (Stopped, DeviceError):  # the loop has ended, and its owner knows why
            return
        except BaseException as error:  # noqa: BLE001 - `check` raises it
            if not self._ending.is_set():
                self._fault = error

    def _play(self) -> bool:
        """Play the film until it ends; return False if the source could not be opened yet."""
        try:
            reliefs = self._reliefs.__enter__()
        except TangibleError as error:
            self._screen.skip(error)
            return False
        self._began_s = None
        try:
            self._show_all(reliefs)
        finally:
            reliefs.__exit__(None, None, None)
        return True

    def _show_all(self, reliefs: Reliefs) -> None:
        frame_s, again_s = 1 / reliefs.frames.fps, 0.0
        while not self._ending.is_set():
            frame, now_s = self._due(reliefs.frames), time.monotonic()
            if frame is not None and (relief := self._make(reliefs, frame)) is not None:
                self._screen.show(relief)
                again_s = self._note(frame.time_s) + frame_s
            elif self._screen.waits and now_s >= again_s:
                self._screen.repeat()
                again_s = now_s + frame_s
            else:
                self._ending.wait(min(frame_s / 8, MAX_WAIT_S))
            self._skip_count = reliefs.frames.skipped

    def _due(self, frames: VideoFrames) -> VideoFrame | None:
        """Return the frame that is due now, if it is new; the first one starts the film's time."""
        try:
            if self._began_s is not None:
                return frames.at(time.monotonic() - self._began_s)
            if (first := frames.next()) is not None:
                self._began_s = time.monotonic() - first.time_s
            return first
        except TangibleError as error:
            self._screen.skip(error)
            return None

    def _make(self, reliefs: Reliefs, frame: VideoFrame) -> FrameRelief | None:
        try:
            return reliefs.make(frame)
        except TangibleError as error:
            self._screen.skip(error)
            return None

    def _note(self, due_s: float) -> float:
        """Note that the frame due at this time of the film was shown; return the present time."""
        self._until_s = time.monotonic()
        self._since_s = self._since_s or self._until_s
        self._ages_s.append(self._until_s - due_s - (self._began_s or 0.0))
        return self._until_s


@final
class ByClock:
    """A function that plays a film to a loop in simulated time: each frame when it is due by the loop's clock."""

    def __init__(self, reliefs: Reliefs, film: Film) -> None:
        """Read the first frame. reliefs: already open. Raises: TangibleError as `Reliefs`."""
        self._reliefs, self._screen = reliefs, _Screen(film)
        self._frame_s = 1 / reliefs.frames.fps
        self._again_s = 0.0
        self._until_s = 0.0
        self._next = self._read()

    def __call__(self, time_s: float) -> None:
        """Show the frames due by now. Raises: whatever a plugin raises."""
        while self._next is not None and self._next.time_s <= time_s:
            frame, self._next = self._next, None
            try:
                self._screen.show(self._reliefs.make(frame))
                self._until_s = frame.time_s
            except TangibleError as error:
                self._screen.skip(error)
            self._again_s = time_s + self._frame_s
            self._next = self._read()
        if time_s >= self._again_s:
            self._again_s = time_s + self._frame_s
            if self._screen.waits:
                self._screen.repeat()
            if self._next is None and not self._reliefs.frames.at_end:
                self._next = self._read()

    def with_counts(self, on_report: Callable[[ServoReport], None]) -> Callable[[ServoReport], None]:
        """Return a function that adds the counts of the film to a report, and passes it on."""
        return lambda report: on_report(replace(report, film=self.counts))

    @property
    def counts(self) -> FilmFelt:
        """The counts of the film so far."""
        per_s = (self._screen.show_count - 1) / self._until_s if self._until_s > 0 else 0.0
        return self._screen.counts(self._reliefs.frames.skipped, per_s, None)

    def _read(self) -> VideoFrame | None:
        try:
            return self._reliefs.frames.next()
        except TangibleError as error:
            self._screen.skip(error)
            return None
