"""Who shows the reliefs of a film to a loop: a thread in real time, or a function of simulated time."""

import logging
import os
import statistics
import sys
import threading
import time
from collections import deque
from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from typing import Protocol, final

from ...data import FilmFelt, Relief, ServoReport
from ...errors import BrokenMethod, DeviceError, Stopped, TangibleError
from ...runtime.stopping import stoppable
from ...runtime.threads import limited_threads, processors, thread_limit
from ...scene.video.frames import VideoFrame, VideoFrames
from .reliefs import FrameRelief, Reliefs

log = logging.getLogger(__name__)
STOPPING_S = 0.5
"""A player is waited for so long when it is to end; one that computes still is left to itself."""
OPEN_AGAIN_S = 1.0
"""A source that could not be opened is tried again so often."""
NICENESS = 5
"""By which the thread goes behind the force loop's process, where the system can do that for a thread."""
MOST_WAIT_S = 0.01
"""Between two looks for a frame."""
AGES = 1000


class Shown(Protocol):
    """Where reliefs are shown: a `Film`, or a loop that feels one."""

    def show(self, relief: Relief, frame: int) -> None:
        """Where the surface goes from here."""
        ...

    @property
    def arrived(self) -> bool:
        """Whether it is there, or will be within the time of a frame."""
        ...

    @property
    def dropped(self) -> int:
        """How many were shown that the loop never went to."""
        ...


@final
class _Screen:
    """What was shown, and what could not be; what cannot be shown is said once, and the surface stands meanwhile."""

    def __init__(self, film: Shown) -> None:
        self._film = film
        self._last: FrameRelief | None = None
        self._said = set[type]()
        self.shown = self.damaged = 0

    def show(self, made: FrameRelief) -> None:
        """The next frame."""
        self._film.show(made.relief, made.number)
        self._last = made
        self.shown += 1

    @property
    def waits(self) -> bool:
        """Whether the surface has yet to come to what was shown last."""
        return self._last is not None and not self._film.arrived

    def again(self) -> None:
        """The last one, as the surface moves no faster than it may."""
        if self._last is not None:
            self._film.show(self._last.relief, self._last.number)

    def stands(self, error: TangibleError) -> None:
        """A frame could not be had. Raises: the error if it is a plugin's fault."""
        if isinstance(error, BrokenMethod | Stopped):
            raise error
        self.damaged += 1
        if type(error) not in self._said:
            self._said.add(type(error))
            log.warning("the surface stands still until a frame can be felt again: %s", error)

    @property
    def dropped(self) -> int:
        """How many were shown that the loop never went to."""
        return self._film.dropped


@final
class Player:
    """Plays a film to a loop in real time, in a thread of its own: the latest frame wins.

    Where the source ends, or gives nothing that can be felt, the surface stands. One processor is left to the loop.
    """

    def __init__(self, reliefs: Reliefs, film: Shown, threads: int | None = None) -> None:
        """threads: the most that work at once, as `Pipeline.threads`."""
        self._reliefs, self._screen = reliefs, _Screen(film)
        self._threads = max(1, min(threads or thread_limit() or processors(), processors() - 1))
        self._ending = threading.Event()
        self._fault: BaseException | None = None
        self._skipped = 0
        self._began_s: float | None = None
        self._since_s = self._until_s = 0.0
        self._ages_s = deque[float](maxlen=AGES)
        self._thread = threading.Thread(target=self._run, name="film", daemon=True)

    def start(self) -> None:
        """Begin with the first frame."""
        self._thread.start()

    def stop(self) -> None:
        """Show nothing more. Returns within a second, though a slow method may be at work for longer."""
        self._ending.set()
        if self._thread.is_alive():
            self._thread.join(STOPPING_S)

    def check(self) -> None:
        """Raises: what a plugin raised."""
        if self._fault is not None:
            fault, self._fault = self._fault, None
            raise fault

    @property
    def felt(self) -> FilmFelt:
        """How it is played."""
        shown, seconds = self._screen.shown, self._until_s - self._since_s
        return FilmFelt(
            shown=shown,
            dropped=self._screen.dropped,
            skipped=self._skipped,
            damaged=self._screen.damaged,
            per_s=(shown - 1) / seconds if seconds > 0 else 0.0,
            age_ms=1e3 * statistics.median(list(self._ages_s)) if self._ages_s else None,
        )

    def _run(self) -> None:
        _go_behind()
        try:
            with stoppable(self._ending), limited_threads(self._threads):
                while not self._ending.is_set():
                    with suppress(_Unopened):
                        self._play()
                        return
                    self._ending.wait(OPEN_AGAIN_S)
        except (Stopped, DeviceError):  # of a loop that has ended, whoever watches it hears why
            return
        except BaseException as error:  # noqa: BLE001 - whoever watches the loop raises it
            if not self._ending.is_set():
                self._fault = error

    def _play(self) -> None:
        try:
            reliefs = self._reliefs.__enter__()
        except TangibleError as error:
            self._screen.stands(error)
            raise _Unopened from error
        self._began_s = None
        try:
            self._show_all(reliefs)
        finally:
            reliefs.__exit__(None, None, None)

    def _show_all(self, reliefs: Reliefs) -> None:
        frame_s, again_s = 1 / reliefs.frames.fps, 0.0
        while not self._ending.is_set():
            frame, now_s = self._due(reliefs.frames), time.monotonic()
            if frame is not None and (made := self._made(reliefs, frame)) is not None:
                self._screen.show(made)
                again_s = self._note(frame.time_s) + frame_s
            elif self._screen.waits and now_s >= again_s:
                self._screen.again()
                again_s = now_s + frame_s
            else:
                self._ending.wait(min(frame_s / 8, MOST_WAIT_S))
            self._skipped = reliefs.frames.skipped

    def _due(self, frames: VideoFrames) -> VideoFrame | None:
        """The frame to be felt now, if there is a new one; the first begins the film's time."""
        try:
            if self._began_s is not None:
                return frames.at(time.monotonic() - self._began_s)
            if (first := frames.next()) is not None:
                self._began_s = time.monotonic() - first.time_s
            return first
        except TangibleError as error:
            self._screen.stands(error)
            return None

    def _made(self, reliefs: Reliefs, frame: VideoFrame) -> FrameRelief | None:
        try:
            return reliefs.made(frame)
        except TangibleError as error:
            self._screen.stands(error)
            return None

    def _note(self, due_s: float) -> float:
        """That a frame was shown which was due then; when it was."""
        self._until_s = time.monotonic()
        self._since_s = self._since_s or self._until_s
        self._ages_s.append(self._until_s - due_s - (self._began_s or 0.0))
        return self._until_s


@final
class ByClock:
    """Plays a film to a loop in simulated time: each frame when the loop's own clock says so, none left out.

    Called before each tick, with the time since the first one.
    """

    def __init__(self, reliefs: Reliefs, film: Shown) -> None:
        """reliefs: open. Raises: TangibleError as `Reliefs`."""
        self._reliefs, self._screen = reliefs, _Screen(film)
        self._frame_s = 1 / reliefs.frames.fps
        self._again_s = 0.0
        self._until_s = 0.0
        self._next = self._read()

    def __call__(self, time_s: float) -> None:
        """Show what is due by now. Raises: what a plugin raises."""
        while self._next is not None and self._next.time_s <= time_s:
            frame, self._next = self._next, None
            try:
                self._screen.show(self._reliefs.made(frame))
                self._until_s = frame.time_s
            except TangibleError as error:
                self._screen.stands(error)
            self._again_s = time_s + self._frame_s
            self._next = self._read()
        if time_s >= self._again_s:
            self._again_s = time_s + self._frame_s
            if self._screen.waits:
                self._screen.again()
            if self._next is None and not self._reliefs.frames.at_end:
                self._next = self._read()

    def told(self, tell: Callable[[ServoReport], None]) -> Callable[[ServoReport], None]:
        """What passes reports on, how the film is played in them."""
        return lambda report: tell(replace(report, film=self.felt))

    @property
    def felt(self) -> FilmFelt:
        """How it was played."""
        shown, skipped = self._screen.shown, self._reliefs.frames.skipped
        per_s = (shown - 1) / self._until_s if self._until_s > 0 else 0.0
        return FilmFelt(shown, self._screen.dropped, skipped, self._screen.damaged, per_s, None)

    def _read(self) -> VideoFrame | None:
        try:
            return self._reliefs.frames.next()
        except TangibleError as error:
            self._screen.stands(error)
            return None


class _Unopened(Exception):
    """The source could not be opened."""


def _go_behind() -> None:
    """This thread takes the processor after others; on Linux a thread has a niceness of its own."""
    if sys.platform == "linux":
        with suppress(OSError):
            os.setpriority(os.PRIO_PROCESS, threading.get_native_id(), NICENESS)
