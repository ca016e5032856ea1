"""The process of a force loop, told what to do over its standard input.

The loop runs in a thread of its own, so that this one hears commands and signals while compiled code holds no lock.
"""

import gc
import os
import signal
import sys
import threading
from pathlib import Path
from typing import IO, final

from ..errors import DeviceError
from ..interfaces import Link, Touch
from . import loop, parcel, priority
from .ring import COMMAND, STOP, SWAP, Ring
from .wire import Ended, Running, Start, Swap, Swapped, receive, send

GONE = "the program that started the loop is gone"
TERMINATED = "the process was asked to end"
SWITCH_S = 1e-4
"""After so long a thread that holds Python's lock hands it to one that waits: the loop, where it needs Python."""


@final
class Child:
    """One session: a device, and the scenes felt on it one after the other."""

    def __init__(self, commands: IO[bytes], replies: IO[bytes]) -> None:
        self._commands, self._replies = commands, replies
        self._stopped = ""
        self._lock = threading.Lock()

    def main(self) -> None:
        """Until the host, a signal, the device or the time ends it."""
        try:
            start = receive(self._commands)
        except Exception as error:  # noqa: BLE001 - a device's class that cannot be had here is for the host to say
            self._end("", error)
            return
        if not isinstance(start, Start):
            return
        self._ring = Ring.attach(Path(start.ring))
        try:
            touch = parcel.unpack(Path(start.scene))
            with start.device.open() as link:
                self._serve(link, touch, start)
        except Exception as error:  # noqa: BLE001 - whatever a plugin raises is for the host to say
            self._end(str(error) if isinstance(error, DeviceError) else "", error)
        else:
            self._end(self._stopped)

    def _serve(self, link: Link, touch: Touch, start: Start) -> None:
        ring = self._ring
        self._next = loop.prepare(link, touch, ring, start.settings)
        failures: list[Exception] = []
        thread = threading.Thread(target=self._feel, args=(failures,), daemon=True)
        thread.start()
        threading.Thread(target=self._listen, args=(link,), daemon=True).start()
        while thread.is_alive():  # a signal's handler runs between two joins
            thread.join(0.05)
        if failures:
            raise failures[0]

    def _feel(self, failures: list[Exception]) -> None:
        header = self._ring.header
        real_time, granted = priority.ask()
        loop.start_clock(header, real_time)
        self._reply(Running(f"{granted}; {self._next.how}"))
        try:
            while True:
                self._next.run()
                if header[COMMAND] != SWAP:
                    return
                loop.take_over(self._ring)
        except Exception as error:  # noqa: BLE001 - the main thread hands it on, once the force is zero
            failures.append(error)

    def _listen(self, link: Link) -> None:
        while (message := receive(self._commands)) is not None:
            if isinstance(message, Swap):
                self._next = loop.prepare(link, parcel.unpack(Path(message.scene)), self._ring, message.settings)
                self._ring.header[COMMAND] = SWAP
                self._reply(Swapped())
            else:
                self.stop(message.why)
                return
        self.stop(GONE)

    def stop(self, why: str) -> None:
        """End the loop with the next tick."""
        self._stopped = self._stopped or why
        self._ring.header[COMMAND] = STOP

    def terminate(self, number: int, frame: object) -> None:
        """For SIGTERM."""
        self.stop(TERMINATED)

    def _end(self, stopped: str, error: Exception | None = None) -> None:
        try:
            self._reply(Ended(stopped, error))
        except Exception:  # noqa: BLE001 - an error that does not pickle still has a name and a message
            self._reply(Ended(stopped, RuntimeError(f"{type(error).__name__}: {error}")))

    def _reply(self, message: object) -> None:
        with self._lock:
            send(self._replies, message)


def main() -> None:
    """The process. What a plugin prints goes to standard error."""
    replies = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C reaches the host too, which says what is to be done
    sys.setswitchinterval(SWITCH_S)
    commands = open(0, "rb", buffering=0)  # noqa: SIM115 - a buffer's lock would outlive the thread that waits
    child = Child(commands, replies)
    signal.signal(signal.SIGTERM, child.terminate)
    gc.disable()  # a collection takes longer than a tick
    child.main()
