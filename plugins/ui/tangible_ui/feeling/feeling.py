"""The server's force loop: started before there is a scene, swapped, watched. This module does not import numba."""

import pickle
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from threading import Lock
from typing import Any, NamedTuple, final

from tangible_core.errors import DeviceError, TangibleError
from tangible_core.mapping import MappedDevice, WorkspaceMapping, placement_of
from tangible_core.plugins import HapticDevice
from tangible_core.plugins.failures import sentence
from tangible_core.servo import STOP, Beacon, Packed, Safety, Servo, null_touch
from tangible_web.framing import BUTTON_BITS
from tangible_web.hand import Hand
from tangible_web.state_frame import ALONE, OtherLaw, frame_without_loop, newest_frame

# Bits of a device's buttons; and the button by which the page's own hand is pressed down, which ends no beacon.
BUTTONS, PRESSED = (1 << BUTTON_BITS) - 1, 1


def end_loop(servo: Servo) -> str:
    """End a loop if it still runs, and return why it ended."""
    try:
        return servo.stop("stopped").stopped
    except TangibleError as error:
        return str(error)
    except Exception as error:  # noqa: BLE001 - what a plugin raised in the loop is no failure of stopping it
        return sentence(error)


class LoopInput(NamedTuple):
    """The input of the force loop for one scene, as the worker made it."""

    touch: Packed
    law: str
    device_name: str
    device: HapticDevice  # the device, moved by the document's mapping into the picture's frame
    own_hand: bool  # true for the page's own pointer
    mapping: WorkspaceMapping
    safety: Safety
    materials: str = ""  # names of the materials by label, as recordings store them

    @classmethod
    def of(cls, answer: dict[str, Any], channel: str) -> "LoopInput":
        """Build it from the worker's answer. channel: of the page's own pointer."""
        touch = Packed(Path(answer["parcel"]), answer["stiffness_n_per_m"])
        device, mapping, safety = (pickle.loads(answer[name]) for name in ("device", "mapping", "safety"))
        names = answer["law"], answer["device_name"]
        return cls(touch, *names, device, device.follows(channel), mapping, safety, answer.get("materials", ""))

    @property
    def unmapped_device(self) -> HapticDevice:
        """The device without the mapping."""
        return self.device.device if isinstance(self.device, MappedDevice) else self.device


class LoopEnd(NamedTuple):
    """The end of a loop that nobody stopped."""

    why: str
    is_lost: bool  # true if the device was lost; it may come back


@final
class Feeling:
    """The force loop, one at a time, and the page's hand in it. Slow methods block; `cut` and `frame` do not."""

    def __init__(self, channel: str) -> None:
        """channel: of the page's own pointer device."""
        self.channel = channel
        self.hand: Hand = Hand(channel)
        self.loop_input: LoopInput | None = None
        self.is_stopped: bool = False
        """True after a stop: no loop starts until `allow`."""
        self._stops = 0
        self._servo: Servo | None = None
        self._starting: Servo | None = None
        self._device: HapticDevice | None = None
        self._reported_loop: Servo | None = None
        """The loop whose end is known."""
        self._pulling: Servo | None = None
        """The loop with a beacon that is not known to have ended."""
        self._lock = Lock()

    @property
    def own_device(self) -> dict[str, Any]:
        """The page's own device, as a pipeline file writes it."""
        return self.hand.device

    @property
    def servo(self) -> Servo | None:
        """The loop; None before the first one and between two."""
        return self._servo

    @property
    def running(self) -> bool:
        """True while forces are given."""
        servo = self._servo
        return servo is not None and servo.running and not servo.ring.header[STOP]

    @property
    def how(self) -> str:
        """The loop's scheduling, as the operating system granted it, and how the current force law is computed."""
        return "" if self._servo is None else self._servo.how

    def start(self) -> float | None:
        """Start the loop on the page's own device; return the seconds, None after a stop. Raises: DeviceError."""
        from tangible_core import load_method

        options = {name: value for name, value in self.own_device.items() if name != "use"}
        begun_s = time.monotonic()
        with self._lock:
            if self.is_stopped or self.running:
                return None
            with self._unless_stopped() as is_stopped:
                self._restart(load_method("device", "pointer")(**options), own_hand=True)
        return None if is_stopped() else time.monotonic() - begun_s

    def feel(self, touch: LoopInput) -> float | None:
        """Put a scene under the hand; return the seconds, None after a stop. Raises: DeviceError; no loop runs then."""
        begun_s = time.monotonic()
        with self._lock:
            try:
                if self.is_stopped:
                    return None
                with self._unless_stopped() as is_stopped:
                    if not self.running or touch.device != self._device:
                        self._restart(touch.device, touch.own_hand)
                    assert self._servo is not None
                    self._servo.swap(touch.touch, touch.safety)
            finally:
                self.loop_input = touch
                touch.touch.discard()
        return None if is_stopped() else time.monotonic() - begun_s

    def pull_to(self, beacon: Beacon | None) -> None:
        """Pull the hand to a part of the surface, or release it. Raises: DeviceError if no loop runs."""
        if beacon is None:
            self._pulling, servo = None, self._servo
            if servo is not None:
                servo.pull_to(None)
            return
        with self._lock:
            servo = self._servo
            if servo is None or not self.running:
                raise DeviceError("nothing is felt, so nothing can be pulled; make and feel a surface first")
            own_hand = self.loop_input is not None and self.loop_input.own_hand
            servo.pull_to(beacon, BUTTONS & ~PRESSED if own_hand else BUTTONS)
            self._pulling = servo

    def beacon_over(self) -> str:
        """Return once why a beacon ended by itself: `button`, `scene` or `ended`; else "". Meant to be polled."""
        servo = self._pulling
        if servo is None or (self.running and servo is self._servo and servo.beacon.part is not None):
            return ""
        self._pulling = None
        return servo.ring.beacon.state.why or "ended"

    def cut(self) -> Callable[[], None]:
        """Take all force away until `allow`; return at once a function that waits for the end of the current loops."""
        self.is_stopped, self._stops = True, self._stops + 1
        self._reported_loop = self._servo
        self.hand.release()
        cut = [servo for servo in (self._starting, self._servo) if servo is not None]
        for servo in cut:
            with suppress(DeviceError):  # a loop without a ring yet begins without force
                servo.ring.header[STOP] = 1

        def wait_until_gone() -> None:
            for servo in cut:
                end_loop(servo)

        return wait_until_gone

    def stop(self) -> None:
        """Take all force away for good; return when the loop has ended. A loop that is starting is not waited for."""
        wait_until_gone = self.cut()
        self.hand.close()
        wait_until_gone()

    def allow(self) -> None:
        """Allow loops to start again."""
        self.is_stopped = False

    def loop_end(self) -> LoopEnd | None:
        """Return once why the loop ended by itself; else None. Meant to be polled."""
        servo = self._servo
        if servo is None or servo.running or servo is self._reported_loop:
            return None
        self._reported_loop = servo
        return None if self.is_stopped else LoopEnd(end_loop(servo), servo.device_lost)

    def frame(self, seq: int, status: int, other_law: OtherLaw = ALONE) -> bytes | None:
        """Return the newest tick as a STATE frame, without a loop a hand that is nowhere; None if overwritten."""
        servo = self._servo
        if servo is None or not self.running:
            return frame_without_loop(seq, status)
        return newest_frame(servo, seq, status, other_law)

    @contextmanager
    def _unless_stopped(self) -> Iterator[Callable[[], bool]]:
        """Suppress errors that a stop causes within the block. Yields: a function that tells if a stop came."""
        before = self._stops

        def is_stopped() -> bool:
            return self._stops != before

        try:
            yield is_stopped
        except DeviceError:
            if not is_stopped():
                raise
        finally:
            if is_stopped() and self._servo is not None:
                end_loop(self._servo)

    def _restart(self, device: HapticDevice, own_hand: bool) -> None:
        """Replace the loop by one on this device; it begins without force."""
        self.hand.close()
        before, self._servo, self._device = self._servo, None, None
        if before is not None:
            end_loop(before)
        self._starting = servo = Servo(null_touch(), device, Safety())
        try:
            servo.__enter__()
            self._servo, self._device = servo, device
        finally:
            self._starting = None
        if own_hand and self.running:
            self.hand.open(placement_of(device))
