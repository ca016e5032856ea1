"""The loop's process as seen by its host: it is started, listened to, watched, and killed if it stands still."""

import logging
import queue
import subprocess
import threading
from contextlib import suppress
from typing import IO, Any, TypeVar, final

import numpy as np

from ..errors import DeviceError
from ..plugins.interfaces import HapticDevice
from ..runtime.child_process import command, pipe_end
from ..runtime.system.processes import start_without_ctrl_c
from . import limits, watchdog
from .framing import End, Refusal, Start, receive, send, sendable
from .ring import STOP, Ring

log: logging.Logger = logging.getLogger(__name__)
OVER = "the time is over"
NOT_STARTED = "no force loop was started; use it in `with Servo(...) as servo:`"
Reply = TypeVar("Reply")


@final
class LoopProcess:
    """The process of one force loop, and the threads of the host that listen to it and watch it."""

    def __init__(self, device: HapticDevice) -> None:
        self._device = device
        self._replies: queue.SimpleQueue[Any] = queue.SimpleQueue()
        self._child: subprocess.Popen[bytes] | None = None
        self._listener: threading.Thread | None = None
        self._over = threading.Event()
        self._has_opened = False  # until then the loop has sent no force
        self.timeout_s: float = limits.WATCHDOG_S
        """The longest time without a tick in the current scene, by `watchdog.timeout_s`."""
        self.why: str = ""
        """The reason for which the host ends the loop."""
        self.end_message: End | None = None
        """The last message, once the loop is over."""

    def start(self, ring: Ring, start: Start) -> None:
        """Start the process in the background; `reply` waits for it."""
        self._listener = threading.Thread(target=self._listen, args=(ring, start), daemon=True)
        self._listener.start()

    def watch(self, ring: Ring) -> None:
        """Watch from now on that ticks go on."""
        threading.Thread(target=self._watch, args=(ring.header,), daemon=True).start()

    def end(self) -> None:
        """End the process: by a closed pipe, or by a kill if it does not end in time."""
        if self._listener is not None and self._listener.is_alive():
            self._close_pipe()
            self._listener.join(limits.KILL_S)
            self._kill("it did not end when it was stopped")
            self._listener.join()

    @property
    def child(self) -> subprocess.Popen[bytes]:
        """The process. Raises: DeviceError if it was not started."""
        if self._child is None:
            raise DeviceError(NOT_STARTED)
        return self._child

    def send(self, message: Any) -> None:
        """Send a message. Raises: DeviceError, or a plugin's error, if the loop has ended."""
        try:
            send(pipe_end(self.child.stdin), message)
        except (OSError, ValueError) as error:  # the process is gone, or the host closed the pipe
            self._over.wait()  # then the reason is known
            raise self.failure() from error

    def reply(self, kind: type[Reply]) -> Reply:
        """Return the next reply. Raises: DeviceError, or a plugin's error, if it is a refusal or the loop has ended."""
        try:
            message = self._replies.get(timeout=limits.FIRST_TICK_S)
        except queue.Empty:
            raise DeviceError(
                f"the force loop has not answered for {limits.FIRST_TICK_S:g} s; see what the device prints"
            ) from None
        if isinstance(message, Refusal):
            raise message.error
        if not isinstance(message, kind):
            raise self.failure()
        return message

    def failure(self) -> Exception:
        """Return the error for a call after the end of the loop."""
        end = self.end_message or End(OVER)
        return end.error or DeviceError(f"the force loop has ended: {end.stopped or OVER}")

    def _close_pipe(self) -> None:
        if self._child is not None:
            with suppress(OSError):  # messages that were not sent are not needed any more
                pipe_end(self._child.stdin).close()

    def _kill(self, why: str) -> None:
        if self._child is not None and self._child.poll() is None:
            level = logging.WARNING if self._has_opened else logging.DEBUG
            log.log(level, "the force loop's process is killed: %s", why)
            self._child.kill()

    def _listen(self, ring: Ring, start: Start) -> None:
        """Start the process and take its messages until it is gone; nothing interrupts this thread."""
        try:
            end = self._run(ring, start)
        except Exception as error:  # noqa: BLE001 - passed to the thread that waits for a reply
            end = End("", sendable(error))
        ring.header[STOP] = 1
        self.end_message = end
        self._replies.put(end)
        self._over.set()

    def _run(self, ring: Ring, start: Start) -> End:
        words = command(f"{__package__}.child")
        try:
            self._child = child = start_without_ctrl_c(words, stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        except OSError as error:
            raise DeviceError(f"no process can be started for the force loop: {error.strerror or error}") from error
        with pipe_end(child.stdout) as replies:
            if ring.header[STOP]:
                self._close_pipe()
            with suppress(OSError, ValueError):  # the process is gone, or the pipe was closed
                send(pipe_end(child.stdin), start)
            end = self._receive_until_end(replies)
            ring.header[STOP] = 1
            self._close_pipe()
            code = self._wait_for_exit(child)
        if end is None:
            self._release_device()
        return end or End(self.why or f"the force loop's process died (exit code {code})")

    def _wait_for_exit(self, child: subprocess.Popen[bytes]) -> int:
        """Return the exit code of a process that has sent its last message; kill it if it does not end."""
        with suppress(subprocess.TimeoutExpired):
            return child.wait(limits.KILL_S)
        self._kill("it did not end when it was stopped")
        return child.wait()

    def _receive_until_end(self, replies: IO[bytes]) -> End | None:
        """Pass replies on until the last message, and return that; None if the process is gone without one."""
        try:
            while (message := receive(replies)) is not None:
                if isinstance(message, End):
                    return End(message.stopped or self.why, message.error)
                self._has_opened = True
                self._replies.put(message)
        except Exception as error:  # noqa: BLE001 - the plugin's error may not be readable here
            return End("", sendable(error))
        return None

    def _watch(self, header: np.ndarray) -> None:
        """Kill a loop that stands still, or does not end when it is stopped."""
        dog = watchdog.Watchdog(header, limits.KILL_S)
        while not self._over.wait(limits.WATCHDOG_POLL_S):
            if dog.expired(self.timeout_s):
                self.why = self.why or watchdog.STOOD_STILL
                self._kill(self.why)
                return

    def _release_device(self) -> None:
        """Take the force from a device whose loop was killed: some hold the last force until the next command."""
        if self._device.spec().simulated:
            return
        answer = threading.Event()
        arguments = (self._device, answer, self._has_opened)
        threading.Thread(target=_open_and_close, args=arguments, daemon=True).start()
        if not answer.wait(limits.KILL_S) and self._has_opened:
            log.warning("the device does not answer and may still hold its last force; switch it off")


def _open_and_close(device: HapticDevice, answer: threading.Event, has_force: bool) -> None:
    try:
        device.open().close()
    except Exception as error:  # noqa: BLE001 - whatever the driver raises, the user has to know
        level = logging.WARNING if has_force else logging.DEBUG
        log.log(level, "the device may still hold its last force: %s; switch it off", error)
    finally:
        answer.set()
