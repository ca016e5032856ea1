"""The process of a force loop, whose main thread takes commands from standard input while a thread ticks."""

import gc
import logging
import os
import signal
import sys
import threading
from contextlib import suppress
from pathlib import Path
from typing import IO, final

from ..errors import DeviceError
from ..plugins.interfaces import Link, Touch, as_touch
from ..runtime.system import priority
from ..runtime.system.console import ENDING, PAUSING, end_before_console, take_input
from ..translation import translate
from . import limits, parcel, watchdog
from .framing import End, Refusal, Start, StartReply, Swap, SwapReply, receive, send, sendable
from .ring import COUNT, STOP, SWAP, Ring
from .ticks import loop

TERMINATED = "the process received a signal to end"
PAUSED = "the program was paused from the keyboard"
# Time after which a thread passes Python's lock to a waiting one, such as a loop that needs Python.
SWITCH_S = 1e-4


class _InLanguage(logging.Handler):
    """Prints what the opening of a device logs in the language of the person at it."""

    def __init__(self, language: str) -> None:
        super().__init__(logging.WARNING)
        self._language = language

    def emit(self, record: logging.LogRecord) -> None:
        with suppress(OSError, ValueError):
            sys.stderr.write(f"{translate(record.getMessage(), self._language)}\n")


@final
class Child:
    """The server of one host: a device, and its scenes one after the other."""

    def __init__(self, commands: IO[bytes], replies: IO[bytes]) -> None:
        self._commands, self._replies = commands, replies
        self._ring: Ring | None = None
        self._end_reason = self._rights = ""
        self._lock = threading.Lock()
        self._scene_taken = threading.Event()

    def main(self) -> None:
        """Run until the host, a signal, the device or the end of the time stops the loop."""
        try:
            start = receive(self._commands)
            if isinstance(start, Start):
                self._open(start)
        except BaseException as error:  # noqa: BLE001 - the host reports whatever a plugin raises
            failure = sendable(error)
            self._reply(End(str(failure) if isinstance(failure, DeviceError) else "", failure))
        else:
            self._reply(End(self._end_reason))
        finally:
            if self._ring is not None:
                self._ring.remove()  # the host has mapped it too, or was killed and cannot remove it

    def _open(self, start: Start) -> None:
        self._ring = ring = Ring.attach(Path(start.ring))
        if self._end_reason:
            self.stop()
        touch = as_touch(parcel.unpack(Path(start.scene)))
        if ring.header[STOP]:
            return
        root = logging.getLogger()
        root.addHandler(own := _InLanguage(start.language))
        with start.device.open() as link:
            root.removeHandler(own)  # to read a catalogue takes longer than a tick
            self._serve(ring, link, touch, start)

    def _serve(self, ring: Ring, link: Link, touch: Touch, start: Start) -> None:
        self._next, self._timeout_s = loop.prepare(link, touch, ring, start.settings), start.timeout_s
        gc.freeze()  # what exists now stays, and is skipped when an earlier scene is collected
        failures: list[BaseException] = []
        thread = threading.Thread(target=self._tick, args=(ring, failures), daemon=True)
        thread.start()
        threading.Thread(target=self._listen, args=(ring, link), daemon=True).start()
        dog = watchdog.Watchdog(ring.header, limits.ABANDON_S)
        while thread.is_alive() and not (_has_begun(ring) and dog.expired(limits.WATCHDOG_OWN_SHARE * self._timeout_s)):
            thread.join(limits.WATCHDOG_POLL_S)  # a signal's handler runs between two joins
        if failures:
            raise failures[0]
        if thread.is_alive():  # the link is closed now, and a thread that wakes cannot write to it
            raise DeviceError(watchdog.STOOD_STILL)

    def _tick(self, ring: Ring, failures: list[BaseException]) -> None:
        try:
            real_time, rights = priority.request()
            loop.start_clock(ring.header, real_time)
            self._rights = rights
            self._reply(StartReply(f"{rights}; {self._next.how}"))
            self._next.run()
            while ring.header[SWAP] and not ring.header[STOP]:
                loop.take_over(ring)
                self._scene_taken.set()
                self._next.run()
        except BaseException as error:  # noqa: BLE001 - the main thread raises it again, once the force is zero
            failures.append(error)
        finally:
            ring.header[STOP] = 1
            self._scene_taken.set()

    def _listen(self, ring: Ring, link: Link) -> None:
        while isinstance(message := receive(self._commands), Swap):
            self._swap(ring, link, message)
            gc.collect()
        self.stop()  # the program that started the loop closed the pipe, or is gone

    def _swap(self, ring: Ring, link: Link, message: Swap) -> None:
        try:
            touch = as_touch(parcel.unpack(Path(message.scene)))
            self._next = loop.prepare(link, touch, ring, message.settings)
        except BaseException as error:  # noqa: BLE001 - the current scene stays
            self._reply(Refusal(sendable(error)))
            return
        self._scene_taken.clear()
        ring.header[SWAP] = 1
        if not ring.header[STOP]:  # read after clearing: the loop sets both when it ends, in this order
            self._scene_taken.wait()
        if not ring.header[STOP]:
            self._timeout_s = message.timeout_s
            self._reply(SwapReply(f"{self._rights}; {self._next.how}"))

    def stop(self, why: str = "") -> None:
        """End the loop with the next tick."""
        self._end_reason = self._end_reason or why
        if self._ring is not None:
            self._ring.header[STOP] = 1

    def _reply(self, message: object) -> None:
        with self._lock, suppress(OSError):  # the host may be gone
            send(self._replies, message)


def _has_begun(ring: Ring) -> bool:
    """Return whether the first tick is over, before which rights are granted and clocks started, or none may come."""
    return bool(ring.header[COUNT] or ring.header[STOP])


def main() -> None:
    """Run the process; the output of plugins goes to standard error."""
    replies = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C reaches the host too, which decides
    sys.setswitchinterval(SWITCH_S)
    child, over = Child(take_input(), replies), threading.Event()
    end_before_console(lambda: child.stop(TERMINATED), over, ignore_ctrl_c=True)
    for number in ENDING:  # they reach the loop too, but must not end it at once
        if signal.getsignal(number) != signal.SIG_IGN:  # nohup ignores it: the program goes on, and so does its loop
            signal.signal(number, lambda _number, _frame: child.stop(TERMINATED))
    for number in PAUSING:  # Ctrl-Z: a suspended process would leave its force on
        signal.signal(number, lambda _number, _frame: child.stop(PAUSED))
    gc.disable()  # a collection takes longer than a tick
    child.main()
    over.set()
