"""Recording of a running loop, tick by tick, into a file."""

import threading
from collections.abc import Callable
from pathlib import Path
from typing import final

from tangible_core.errors import TangibleError
from tangible_core.servo import Servo
from tangible_core.session import About, RingDrain, Writer

# Seconds between two writes: what a crash of the server can lose of a recording.
LOOK_EVERY_S = 0.05
BY_HAND = "stopped by hand"


@final
class Recorder:
    """A growing recording, written by its own thread; `stop`, the end of the loop, or a write error end it."""

    def __init__(self, servo: Servo, path: Path, about: About, ended: Callable[[Path, int, str], None]) -> None:
        """Begin. ended: called in a thread with the file, number of ticks and reason. Raises: OutputError."""
        self.path = path
        self._servo, self._on_end = servo, ended
        self._writer = Writer(path, about, private=True)
        self._drain = RingDrain(servo, self._writer.append, servo.ring.count)
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._record, daemon=True)
        self._thread.start()

    @property
    def recording(self) -> bool:
        """True while ticks are written."""
        return self._thread.is_alive()

    def stop(self) -> None:
        """End the recording; return when the file is closed. A second call does nothing."""
        self._stop.set()
        self._thread.join()

    def _record(self) -> None:
        why = ""
        try:
            while not why:
                is_stopped = self._stop.wait(LOOK_EVERY_S)
                running = self._servo.running  # asked before the look, so that the last ticks are kept
                self._drain.look()
                why = BY_HAND if is_stopped else "" if running else self._servo.report().stopped
        except TangibleError as error:
            why = str(error)
        self._writer.close("" if why == BY_HAND else why)
        self._on_end(self.path, self._writer.ticks, why)
