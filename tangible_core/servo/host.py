"""A force loop from outside: start it, watch it, swap its scene, stop it."""

import time
from contextlib import suppress
from pathlib import Path
from typing import Any, Self, final

from ..data import Relief, ServoReport
from ..errors import DeviceError, check_positive
from ..plugins.interfaces import Film, HapticDevice, Touch, as_touch
from ..runtime.system import shared_memory
from ..translation import language
from . import limits as time_limits
from . import parcel
from .beacon import ALL_BUTTONS, ASKED, SEEN, Beacon, BeaconState
from .framing import Start, StartReply, Swap, SwapReply
from .guard.safety import Safety
from .guard.stiffness import find_stiffness
from .parcel import Packed
from .reports import report
from .ring import LAST, PERIOD_NS, STOP, Ring
from .supervisor import NOT_STARTED, OVER, LoopProcess
from .watchdog import STOOD_STILL, timeout_s

FOREVER = 2**62  # number of ticks of a loop without end


@final
class Servo:
    """A force loop in its own process, as a context manager: when it is left, no force remains.

    The touch and the device's options travel to that process, which opens the device. It ends, with zero force, when it
    is stopped, when its time is over, when this process is gone, on SIGTERM, and when the device stops answering. A
    process that stands still is killed, and the device is opened once more to release it.
    """

    def __init__(
        self,
        touch: Touch | Film,
        device: HapticDevice,
        limits: Safety | None = None,
        seconds: float | None = None,
        period_s: float = 0.001,
    ) -> None:
        """Prepare a loop that ends by itself after `seconds`; never, if that is None.

        Raises: ConfigError if seconds or the period is not positive and finite.
        """
        check_positive("seconds", 1.0 if seconds is None else seconds)
        check_positive("period_s", period_s)
        self._touch, self._device, self._limits = touch, device, limits or Safety()
        self._period_s = period_s
        self._ticks = FOREVER if seconds is None else max(1, round(seconds / period_s))
        self._loop = LoopProcess(device)
        self._ring: Ring | None = None
        self._film: Film | None = None
        self._parcels = [touch.parcel] if isinstance(touch, Packed) else list[Path]()
        self.how: str = ""
        """A sentence about the granted rights, the kind of loop, and the stiffness of the current scene if measured."""
        self.start_s: float = 0.0
        """Time from the request for the loop to its first tick."""

    def __enter__(self) -> Self:
        """Start the loop. Raises: DeviceError if the device cannot be opened, and whatever a faulty plugin raises."""
        start_s = time.monotonic()
        try:
            self._ring = Ring.create()
            settings, memory = self._arrays(self._touch)
            self.ring.guard[: memory.size] = memory
            self.ring.header[[PERIOD_NS, LAST]] = round(self._period_s * 1e9), self._ticks
            scene, film = self._pack(self._touch)
            ring = str(self.ring.path)
            self._loop.start(self.ring, Start(ring, scene, self._device, settings, self._timeout_s, language()))
            self._note_scene(self._loop.reply(StartReply), film)
            self._loop.watch(self.ring)
            self.start_s = time.monotonic() - start_s
            return self
        except BaseException:
            self._close()
            raise

    def __exit__(self, *_: object) -> None:
        try:
            self.stop()
        finally:
            self.ring.header[STOP] = 1  # even if the stop was interrupted

    def swap(self, touch: Touch | Film, limits: Safety | None = None) -> None:
        """Go on with another scene from one tick to the next; its force fades in. Returns once it acts.

        limits: from then on; if None, the limits stay.
        Raises: DeviceError if the loop has ended, or the touch cannot be sent to its process; whatever a faulty plugin
        raises there. The scene before it stays, unless the loop has ended.
        """
        self._limits = limits or self._limits
        try:
            scene, film = self._pack(touch)
            self._loop.send(Swap(scene, self._arrays(touch)[0], self._timeout_s))
            self._note_scene(self._loop.reply(SwapReply), film)
        finally:
            self._remove_sent()

    def show(self, relief: Relief, frame: int) -> None:
        """Move the surface to a relief from now on, as `Film.show`; only writes to memory that the loop reads.

        Raises: DeviceError if the scene is not a film, or the loop has ended; GeometryError as `Film.show`.
        """
        if not self.running:
            raise self._loop.failure()
        if self._film is None:
            raise DeviceError("the surface stands still and shows no frame; start with a film of a force law (`film`)")
        self._film.show(relief, frame)

    @property
    def film(self) -> Film | None:
        """The film of the current or last scene, in the memory that the loop reads; None if the surface is at rest."""
        return self._film

    def pull_to(self, beacon: Beacon | None, buttons: int = ALL_BUTTONS) -> None:
        """Pull the hand gently to a part of the surface from now on, in place of any earlier beacon; stop if None.

        The pull fades in over half a second, stops while the hand is on the part, and starts again when it leaves it.
        It is released, within the tick, when a button is pressed, until this is called again; and by another scene.
        buttons: bits of the buttons that release it.
        Raises: DeviceError if the loop has ended, or there is no room for the beacon.
        """
        memory = self.ring.beacon
        memory.words[ASKED] = 0
        if beacon is None:
            return
        if not self.running:
            raise self._loop.failure()
        self.ring.allocate_beacon()
        until_s = time.monotonic() + time_limits.KILL_S
        while memory.words[SEEN]:  # until then, the loop may read the field of the beacon before
            if not self.running or time.monotonic() > until_s:
                raise self._loop.failure()
            time.sleep(self._period_s)
        memory.put(beacon, buttons)

    @property
    def beacon(self) -> BeaconState:
        """The state of the beacon; off once the loop has ended."""
        return self.ring.beacon.state if self.running else BeaconState(None)

    @property
    def ring(self) -> Ring:
        """The memory that the loop shares."""
        if self._ring is None:
            raise DeviceError(NOT_STARTED)
        return self._ring

    @property
    def process_id(self) -> int:
        """The ID of the loop's process."""
        return self._loop.child.pid

    @property
    def running(self) -> bool:
        """True while the loop runs."""
        return self._loop.end_message is None

    @property
    def device_lost(self) -> bool:
        """True if the device ended the loop, or prevented its start: it was absent, or stopped answering."""
        end = self._loop.end_message
        return end is not None and (isinstance(end.error, DeviceError) or end.stopped == STOOD_STILL)

    def report(self) -> ServoReport:
        """Return a report of the loop so far."""
        end = self._loop.end_message
        return report(self.ring, (end.stopped or OVER) if end else "")

    def stop(self, why: str = "stopped") -> ServoReport:
        """End the loop, if it still runs, and report on it. Raises: whatever a faulty plugin raised in the loop."""
        self._loop.why = self._loop.why or why
        self._close()
        error = self._loop.end_message and self._loop.end_message.error
        if error is not None and not isinstance(error, DeviceError):
            raise error
        return self.report()

    def _close(self) -> None:
        """Leave neither a process nor a file nor a force."""
        if self._ring is not None:
            self._ring.header[STOP] = 1
        self._loop.end()
        self._remove_sent()
        if self._ring is not None:
            self._ring.remove()

    def _pack(self, touch: Touch | Film) -> tuple[str, Film | None]:
        """Return the file of a parcel, and the film in it, in the memory that the loop's process will share."""
        if isinstance(touch, Packed):
            self._parcels.append(touch.unused_parcel())
            return str(self._parcels[-1]), touch.film
        self._parcels.append(path := parcel.pack(touch))
        return str(path), parcel.share(path) if isinstance(touch, Film) else None

    def _remove_sent(self) -> None:
        """Delete parcels that the loop did not consume; `stop` and `swap` may do so at the same time."""
        with suppress(IndexError):
            while True:
                shared_memory.remove(self._parcels.pop())

    def _arrays(self, touch: Touch | Film) -> tuple[Any, Any]:
        spec = self._device.spec()
        self._stiffness = find_stiffness(as_touch(touch), spec)
        return self._limits.arrays(spec, self._stiffness.n_per_m)

    @property
    def _timeout_s(self) -> float:
        return timeout_s(self._limits.watchdog_s, self._period_s)

    def _note_scene(self, reply: StartReply | SwapReply, film: Film | None) -> None:
        self._film, self._loop.timeout_s = film, self._timeout_s
        self.how = "; ".join(filter(None, (reply.how, self._stiffness.how)))
