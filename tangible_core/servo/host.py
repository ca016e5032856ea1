"""A force loop from outside: start it, watch it, give it another scene, stop it."""

import logging
import queue
import signal
import subprocess
import threading
import time
from contextlib import suppress
from pathlib import Path
from types import TracebackType
from typing import IO, Any, Self, TypeVar, final

from ..data import Relief, ServoReport
from ..errors import DeviceError, check_positive
from ..plugins.interfaces import Film, HapticDevice, Touch, touch_of
from ..runtime.child_process import command
from . import parcel
from .beacon import ALL_BUTTONS, ASKED, SEEN, Beacon, BeaconState
from .guard.safety import Safety
from .guard.stiffness import stiffness_of
from .packed import Packed
from .reports import report
from .ring import COUNT, LAST, PERIOD_NS, STOP, Ring
from .wire import End, Refusal, Start, StartReply, Swap, SwapReply, receive, send, sendable

log = logging.getLogger(__name__)
COMPILING_S = 300.0
"""A loop that has not begun by then never will; compiling everything takes a tenth of it."""
STOPPING_S = 3.0
"""A loop that has not ended so long after it was asked to is killed."""
LOOK_EVERY_S, STANDSTILL_S, STANDSTILL_PERIODS = 0.05, 0.2, 4
"""How often ticks are counted; a loop without one for so long, and for so many periods, is killed."""
STOOD_STILL = "the force loop stood still: its law or its device did not answer, or its process was stopped"
FOREVER = 2**62
NOT_STARTED = "no force loop was started; use it in `with Servo(...) as servo:`"
Reply = TypeVar("Reply")
OVER = "the time is over"


@final
class Servo:
    """A force loop in a process of its own, as a context manager: when it is left, no force remains.

    The touch and the device's options travel to that process, which opens the device. It ends, with zero force, when it
    is stopped, when its time is over, when this process is gone, on SIGTERM, and when the device stops answering. One
    that stands still is ended from here, and the device is opened once more to let go.
    """

    def __init__(
        self,
        touch: Touch | Film,
        device: HapticDevice,
        limits: Safety | None = None,
        seconds: float | None = None,
        period_s: float = 0.001,
    ) -> None:
        """seconds: when it ends by itself; never, if there are none.

        Raises: ConfigError if seconds or the period is not positive and finite.
        """
        check_positive("seconds", 1.0 if seconds is None else seconds)
        check_positive("period_s", period_s)
        self._touch, self._device, self._limits = touch, device, limits or Safety()
        self._period_s = period_s
        self._ticks = FOREVER if seconds is None else max(1, round(seconds / period_s))
        self._replies: queue.SimpleQueue[Any] = queue.SimpleQueue()
        self._ring: Ring | None = None
        self._child: subprocess.Popen[bytes] | None = None
        self._ear: threading.Thread | None = None
        self._film: Film | None = None
        self._sent = [touch.parcel] if isinstance(touch, Packed) else list[Path]()
        self._why = ""
        self._ended: End | None = None
        self._heard = threading.Event()
        self.how = ""
        """What the operating system granted, which loop runs, and how stiff the law is if it does not say so; of the
        scene that is felt now."""
        self.start_s = 0.0
        """From asking for the loop to its first tick."""

    def __enter__(self) -> Self:
        """Raises: DeviceError if the device cannot be opened, and whatever a faulty plugin raises."""
        begun_s = time.monotonic()
        try:
            self._ring = Ring.create()
            settings, memory = self._arrays(self._touch)
            self.ring.guard[: memory.size] = memory
            self.ring.header[[PERIOD_NS, LAST]] = round(self._period_s * 1e9), self._ticks
            scene, film = self._pack(self._touch)
            start = Start(str(self.ring.path), scene, self._device, settings)
            self._ear = threading.Thread(target=self._hear, args=(start,), daemon=True)
            self._ear.start()
            self._felt_now(self._answer(StartReply), film)
            threading.Thread(target=self._watch, daemon=True).start()
            self.start_s = time.monotonic() - begun_s
            return self
        except BaseException:
            self._close()
            raise

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        try:
            self.stop()
        finally:
            self.ring.header[STOP] = 1  # whatever interrupted that

    def swap(self, touch: Touch | Film, limits: Safety | None = None) -> None:
        """Feel another scene from one tick to the next; the force fades in. Returns when it is felt.

        limits: from then on; without any, those of before.
        Raises: DeviceError if the loop has ended, or the touch cannot be sent to its process; whatever a faulty plugin
        raises there. The scene before it is felt on, unless the loop has ended.
        """
        self._limits = limits or self._limits
        try:
            scene, film = self._pack(touch)
            self._tell(Swap(scene, self._arrays(touch)[0]))
            self._felt_now(self._answer(SwapReply), film)
        finally:
            self._remove_sent()

    def show(self, relief: Relief, frame: int) -> None:
        """Where the surface that is felt goes from here, as `Film.show`: what the loop reads is written to, no more.

        Raises: DeviceError if nothing that moves is felt, or the loop has ended; GeometryError as `Film.show`.
        """
        if not self.running:
            raise self._failure()
        if self._film is None:
            raise DeviceError("what is felt stands still and shows no frame; feel the film that a law makes (`film`)")
        self._film.show(relief, frame)

    @property
    def film(self) -> Film | None:
        """The film that is felt, or was at the end, in the memory that the loop reads; none where nothing moves."""
        return self._film

    def pull_to(self, beacon: Beacon | None, buttons: int = ALL_BUTTONS) -> None:
        """Pull the hand gently to a part of the surface that is felt, from now on; or let go of it at once.

        The pull fades in over half a second, ends where the hand is on the part, and begins again where it leaves it. A
        button that is pressed releases it within the tick, until this is called again; so does another scene.
        buttons: bits of those that do. A second call takes the place of the first.
        Raises: DeviceError if the loop has ended, or there is no room for the beacon.
        """
        memory = self.ring.beacon
        memory.words[ASKED] = 0
        if beacon is None:
            return
        self.ring.allocate_beacon()
        until_s = time.monotonic() + STOPPING_S
        while memory.words[SEEN]:  # until then, the loop may read the field of the one before
            if not self.running or time.monotonic() > until_s:
                raise self._failure()
            time.sleep(self._period_s)
        memory.put(beacon, buttons)

    @property
    def beacon(self) -> BeaconState:
        """Whether a beacon pulls, and why not; of a loop that has ended, none does."""
        return self.ring.beacon.state if self.running else BeaconState(None)

    @property
    def ring(self) -> Ring:
        """What the loop shares."""
        if self._ring is None:
            raise DeviceError(NOT_STARTED)
        return self._ring

    @property
    def process_id(self) -> int:
        """Of the loop's process."""
        return self._started.pid

    @property
    def running(self) -> bool:
        """Whether ticks go on."""
        return self._ended is None

    @property
    def lost(self) -> bool:
        """Whether the loop ended, or did not begin, because of its device: that was not there, or does not answer."""
        ended = self._ended
        return ended is not None and (isinstance(ended.error, DeviceError) or ended.stopped == STOOD_STILL)

    def report(self) -> ServoReport:
        """How the loop is doing, or how it was."""
        return report(self.ring, (self._ended.stopped or OVER) if self._ended else "")

    def stop(self, why: str = "stopped") -> ServoReport:
        """End the loop, if it still runs, and say how it was. Raises: whatever a faulty plugin raised in the loop."""
        self._why = self._why or why
        self._close()
        error = self._ended and self._ended.error
        if error is not None and not isinstance(error, DeviceError):
            raise error
        return self.report()

    def _close(self) -> None:
        """Leave neither a process nor a file nor a force."""
        if self._ring is not None:
            self._ring.header[STOP] = 1
        if self._ear is not None and self._ear.is_alive():
            self._hang_up()
            self._ear.join(STOPPING_S)
            self._kill("it did not end when asked to")
            self._ear.join()
        self._remove_sent()
        if self._ring is not None:
            self._ring.remove()

    @property
    def _started(self) -> subprocess.Popen[bytes]:
        if self._child is None:
            raise DeviceError(NOT_STARTED)
        return self._child

    def _hang_up(self) -> None:
        if self._child is not None:
            with suppress(OSError):  # what was not sent is not missed
                _pipe(self._child.stdin).close()

    def _kill(self, why: str) -> None:
        if self._child is not None and self._child.poll() is None:
            log.warning("the force loop's process is killed: %s", why)
            self._child.kill()

    def _pack(self, touch: Touch | Film) -> tuple[str, Film | None]:
        """The file of a parcel, and the film in it, in the memory that whoever unpacks it has too."""
        if isinstance(touch, Packed):
            self._sent.append(touch.unused_parcel())
            return str(self._sent[-1]), touch.film
        self._sent.append(path := parcel.pack(touch))
        return str(path), parcel.share(path) if isinstance(touch, Film) else None

    def _remove_sent(self) -> None:
        """Scenes that were not taken out of their files; who stops and who swaps may do it at once."""
        with suppress(IndexError):
            while True:
                self._sent.pop().unlink(missing_ok=True)

    def _arrays(self, touch: Touch | Film) -> tuple[Any, Any]:
        spec = self._device.spec()
        self._felt = stiffness_of(touch_of(touch), spec)
        return self._limits.arrays(spec, self._felt.n_per_m)

    def _tell(self, message: Any) -> None:
        try:
            send(_pipe(self._started.stdin), message)
        except (OSError, ValueError) as error:  # gone, or closed from here
            self._heard.wait()  # then it is known why
            raise self._failure() from error

    def _answer(self, kind: type[Reply]) -> Reply:
        try:
            message = self._replies.get(timeout=COMPILING_S)
        except queue.Empty:
            raise DeviceError(
                f"the force loop has not answered for {COMPILING_S:g} s; look at what the device prints"
            ) from None
        if isinstance(message, Refusal):
            raise message.error
        if not isinstance(message, kind):
            raise self._failure()
        return message

    def _felt_now(self, reply: StartReply | SwapReply, film: Film | None) -> None:
        self._film = film
        self.how = "; ".join(filter(None, (reply.how, self._felt.how)))

    def _failure(self) -> Exception:
        ended = self._ended or End(OVER)
        return ended.error or DeviceError(f"the force loop has ended: {ended.stopped or OVER}")

    def _hear(self, start: Start) -> None:
        """Start the loop's process and take its messages, until it is gone; nothing interrupts this thread."""
        try:
            ended = self._live(start)
        except Exception as error:  # noqa: BLE001 - whoever waits for an answer is to get it
            ended = End("", sendable(error))
        self.ring.header[STOP] = 1
        self._ended = ended
        self._replies.put(ended)
        self._heard.set()

    def _live(self, start: Start) -> End:
        if hasattr(signal, "pthread_sigmask"):  # the process hears no Ctrl-C before it can choose to
            signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
        words = command(f"{__package__}.child")
        try:
            self._child = child = subprocess.Popen(words, stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        except OSError as error:
            raise DeviceError(f"no process can be started for the force loop: {error.strerror or error}") from error
        with _pipe(child.stdout) as replies:
            if self.ring.header[STOP]:
                self._hang_up()
            with suppress(OSError, ValueError):  # it is gone, or was hung up on
                send(_pipe(child.stdin), start)
            ended = self._last_words(replies)
            self.ring.header[STOP] = 1
            self._hang_up()
            code = self._reaped(child)
        if ended is None:
            self._let_go()
        return ended or End(self._why or f"the force loop's process died (exit code {code})")

    def _reaped(self, child: subprocess.Popen[bytes]) -> int:
        """Exit code of a process that has said its last words; killed if it does not end."""
        with suppress(subprocess.TimeoutExpired):
            return child.wait(STOPPING_S)
        self._kill("it did not end when asked to")
        return child.wait()

    def _last_words(self, replies: IO[bytes]) -> End | None:
        """Pass the others on until there is this one, or the loop is gone without."""
        try:
            while (message := receive(replies)) is not None:
                if isinstance(message, End):
                    return End(message.stopped or self._why, message.error)
                self._replies.put(message)
        except Exception as error:  # noqa: BLE001 - what a plugin raised may not be told from here
            return End("", sendable(error))
        return None

    def _watch(self) -> None:
        """Kill a loop that stands still, or does not end when asked to."""
        header, seen, looks = self.ring.header, -1, 0
        standstill_s = max(STANDSTILL_S, STANDSTILL_PERIODS * self._period_s)
        while not self._heard.wait(LOOK_EVERY_S):  # looks are counted, not seconds: this process may have stood still
            ending = header[STOP] or header[COUNT] >= header[LAST]
            looks = looks + 1 if header[COUNT] == seen else 0
            seen = int(header[COUNT])
            if looks * LOOK_EVERY_S >= (STOPPING_S if ending else standstill_s):
                self._why = self._why or STOOD_STILL
                self._kill(self._why)
                return

    def _let_go(self) -> None:
        """Take the force from a device whose loop was killed: some hold the last one until they hear otherwise."""
        if self._device.spec().simulated:
            return
        done = threading.Event()
        threading.Thread(target=_open_and_close, args=(self._device, done), daemon=True).start()
        if not done.wait(STOPPING_S):
            log.warning("the device does not answer and may still hold its last force; switch it off")


def _open_and_close(device: HapticDevice, done: threading.Event) -> None:
    try:
        device.open().close()
    except Exception as error:  # noqa: BLE001 - whatever the driver raises, a person has to know
        log.warning("the device may still hold its last force: %s; switch it off", error)
    finally:
        done.set()


def _pipe(end: IO[bytes] | None) -> IO[bytes]:
    assert end is not None  # both are asked for
    return end
