"""A force loop from outside: start it, watch it, give it another scene, stop it."""

import logging
import math
import queue
import subprocess
import threading
import time
from types import TracebackType
from typing import Any, Self, TypeVar, final

from ..child_process import command
from ..data import ServoReport
from ..errors import ConfigError, DeviceError
from ..interfaces import HapticDevice, Touch
from . import parcel
from .reports import report
from .ring import LAST, PERIOD_NS, Ring
from .safety import Safety
from .stiffness import stiffness_of
from .wire import Ended, Running, Start, Stop, Swap, Swapped, receive, send

log = logging.getLogger(__name__)
COMPILING_S = 300.0
"""A loop that has not begun by then never will; compiling everything takes a tenth of it."""
STOPPING_S = 3.0
"""A loop that has not ended so long after it was asked to is killed."""
FOREVER = 2**62
Reply = TypeVar("Reply")
OVER = "the time is over"


@final
class Servo:
    """A force loop in a process of its own, as a context manager: when it is left, no force remains.

    The touch and the device's options travel to that process, which opens the device. It ends, with zero force, when it
    is stopped, when its time is over, when this process is gone, on SIGTERM, and when the device stops answering.
    """

    def __init__(
        self,
        touch: Touch,
        device: HapticDevice,
        limits: Safety | None = None,
        seconds: float | None = None,
        period_s: float = 0.001,
    ) -> None:
        """seconds: when it ends by itself; never, if there are none.

        Raises: ConfigError if seconds or the period is not above 0 and finite.
        """
        for name, value in (("seconds", 1.0 if seconds is None else seconds), ("period_s", period_s)):
            if not 0 < value < math.inf:
                raise ConfigError(f"{name}: is {value}; a session takes more than 0 seconds, and an end")
        self._touch, self._device, self._limits = touch, device, limits or Safety()
        self._period_s = period_s
        self._ticks = FOREVER if seconds is None else max(1, round(seconds / period_s))
        self._replies: queue.SimpleQueue[Any] = queue.SimpleQueue()
        self._ended: Ended | None = None
        self.how = ""
        """What the operating system granted, which loop runs, and how stiff the law is if it does not say so."""
        self.start_s = 0.0
        """From asking for the loop to its first tick."""

    def __enter__(self) -> Self:
        """Raises: DeviceError if the device cannot be opened, and whatever a faulty plugin raises."""
        begun_s = time.monotonic()
        settings, memory = self._arrays(self._touch)
        scene = parcel.pack(self._touch)
        self.ring = Ring.create()
        self.ring.guard[: memory.size] = memory
        self.ring.header[[PERIOD_NS, LAST]] = round(self._period_s * 1e9), self._ticks
        self._child = subprocess.Popen(command(f"{__package__}.child"), stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        self._ear = threading.Thread(target=self._hear, daemon=True)
        self._ear.start()
        try:
            self._tell(Start(str(self.ring.path), str(scene), self._device, settings))
            self.how = "; ".join(filter(None, (self._answer(Running).how, self._felt.how)))
        except BaseException:
            self._close()
            raise
        self.start_s = time.monotonic() - begun_s
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.stop()

    def swap(self, touch: Touch) -> None:
        """Feel another scene from one tick to the next; the force fades in. Returns when it is felt.

        Raises: DeviceError if the loop has ended, or the touch cannot be sent to its process.
        """
        self._tell(Swap(str(parcel.pack(touch)), self._arrays(touch)[0]))
        self._answer(Swapped)

    @property
    def process_id(self) -> int:
        """Of the loop's process."""
        return self._child.pid

    @property
    def running(self) -> bool:
        """Whether ticks go on."""
        return self._ended is None

    def report(self) -> ServoReport:
        """How the loop is doing, or how it was."""
        return report(self.ring, (self._ended.stopped or OVER) if self._ended else "")

    def stop(self, why: str = "stopped") -> ServoReport:
        """End the loop, if it still runs, and say how it was. Raises: whatever a faulty plugin raised in the loop."""
        if self.running:
            self._tell(Stop(why))
        self._close()
        error = self._ended and self._ended.error
        if error is not None and not isinstance(error, DeviceError):
            raise error
        return self.report()

    def _close(self) -> None:
        """Leave neither a process nor a file nor a force."""
        try:
            self._child.wait(STOPPING_S)
        except subprocess.TimeoutExpired:
            log.warning("the force loop did not end when asked to; its process is killed")
            self._child.kill()
        self._ear.join()
        for pipe in (self._child.stdin, self._child.stdout):
            if pipe:
                pipe.close()
        self.ring.remove()

    def _arrays(self, touch: Touch) -> tuple[Any, Any]:
        spec = self._device.spec()
        self._felt = stiffness_of(touch, spec)
        return self._limits.arrays(spec, self._felt.n_per_m)

    def _tell(self, message: Any) -> None:
        try:
            send(self._child.stdin, message)  # pyright: ignore[reportArgumentType]
        except OSError as error:
            self._ear.join()  # it knows why
            if not isinstance(message, Stop):
                raise self._failure() from error

    def _answer(self, kind: type[Reply]) -> Reply:
        try:
            message = self._replies.get(timeout=COMPILING_S)
        except queue.Empty:
            raise DeviceError(
                f"the force loop has not answered for {COMPILING_S:g} s; look at what the device prints"
            ) from None
        if not isinstance(message, kind):
            raise self._failure()
        return message

    def _failure(self) -> Exception:
        ended = self._ended or Ended(OVER)
        return ended.error or DeviceError(f"the force loop has ended: {ended.stopped or OVER}")

    def _hear(self) -> None:
        """Take the loop's messages, until it is gone."""
        while (message := receive(self._child.stdout)) is not None:  # pyright: ignore[reportArgumentType]
            if isinstance(message, Ended):
                self._ended = message
            self._replies.put(message)
        if self._ended is None:
            died = Ended(f"the force loop's process died (exit code {self._child.wait()})")
            self._let_go()
            self._ended = died
            self._replies.put(died)

    def _let_go(self) -> None:
        """Take the force from a device whose loop was killed: some hold the last one until they hear otherwise."""
        if self._device.spec().simulated:
            return
        try:
            self._device.open().close()
        except DeviceError as error:
            log.warning("the device may still hold its last force: %s; switch it off", error)
