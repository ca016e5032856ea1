"""The force loop as the page's server has it: started before there is a scene, swapped, watched. No numba here."""

import math
import pickle
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from threading import Lock
from typing import Any, NamedTuple, final

from tangible_core.data import Vector
from tangible_core.errors import DeviceError, TangibleError
from tangible_core.mapping import MappedDevice, WorkspaceMapping, placement_of
from tangible_core.plugins.failures import sentence
from tangible_core.plugins.interfaces import HapticDevice
from tangible_core.servo import Beacon, Packed, Safety, Servo, still
from tangible_core.servo.ring import STOP

from ..framing import BUTTON_BITS, FLAG_BITS, STATE, STATE_FRAME
from .hand import HIGH_M, Hand

NOBODY: Vector = (0.0, 0.0, 0.0)
UNKNOWN: Vector = (math.nan, math.nan, math.nan)
STALE_AFTER_S = 0.3
"""The server's own silence, after which the loop lets go of the page's hand: a machine that starts a browser keeps it
waiting for a quarter of a second. A page's silence is `hand.SILENT_S`."""
FOLLOW_S = 0.012
"""A mouse moves 60 times a second, the loop looks a thousand times: the hand follows smoothly."""
STOPPED = "stopped"
BUTTONS, PRESSED = (1 << BUTTON_BITS) - 1, 1
"""A device's buttons; and that of the page's own hand by which it is pressed down, and which lets go of no beacon."""


class LoopInput(NamedTuple):
    """What the worker made, as the loop needs it."""

    touch: Packed
    law: str
    device_name: str
    device: HapticDevice
    """As the picture sees it, by the mapping."""
    own_hand: bool
    """Whether that is the page's own pointer."""
    mapping: WorkspaceMapping
    safety: Safety
    materials: str = ""
    """Their names by label, as a recording has them."""

    @classmethod
    def of(cls, made: dict[str, Any], channel: str) -> "LoopInput":
        """From the worker's answer; channel: of the page's own pointer."""
        touch = Packed(Path(made["parcel"]), made["stiffness_n_per_m"])
        parts = (pickle.loads(made[name]) for name in ("device", "mapping", "safety"))
        device, mapping, safety = parts
        own_hand = getattr(without_mapping(device), "channel", None) == channel
        return cls(
            touch, made["law"], made["device_name"], device, own_hand, mapping, safety, made.get("materials", "")
        )

    @property
    def unmapped_device(self) -> HapticDevice:
        """The device itself."""
        return without_mapping(self.device)


class OtherLaw(NamedTuple):
    """What is shown other_law the law that is felt."""

    force_n: Vector = NOBODY
    """Of another law on the same hand."""
    blind: bool = False
    """Whether who feels shall not see which law it is: not every law has a proxy."""


ALONE = OtherLaw()


class LoopEnd(NamedTuple):
    """A loop that ended though nobody stopped it."""

    why: str
    lost: bool
    """Whether its device went: it may come back."""


@final
class Feeling:
    """One force loop at a time, and the page's hand in it.

    What takes long blocks: call it in a thread. `cut` and `frame` do not, and may be called whatever else goes on.
    """

    def __init__(self, channel: str) -> None:
        """channel: of the page's own pointer device."""
        self.channel = channel
        self.hand = Hand(channel)
        self.felt: LoopInput | None = None
        self.stopped = False
        """Whether somebody pressed stop: no loop starts until `allow`."""
        self._stops = 0
        self._servo: Servo | None = None
        self._starting: Servo | None = None
        self._device: HapticDevice | None = None
        self._told: Servo | None = None
        """The loop whose end is known."""
        self._pulling: Servo | None = None
        """The loop in which a beacon was asked for, and is not known to be over."""
        self._lock = Lock()

    @property
    def own_device(self) -> dict[str, Any]:
        """The page's own device, as a pipeline file says it."""
        return {
            "use": "pointer",
            "channel": self.channel,
            "stale_after_s": STALE_AFTER_S,
            "follow_s": FOLLOW_S,
        }

    @property
    def servo(self) -> Servo | None:
        """The loop; None before the first, and between two."""
        return self._servo

    @property
    def running(self) -> bool:
        """Whether forces are given."""
        servo = self._servo
        return servo is not None and servo.running and not servo.ring.header[STOP]

    @property
    def how(self) -> str:
        """What the operating system granted the loop, and how what is felt now is computed."""
        return "" if self._servo is None else self._servo.how

    def start(self) -> float | None:
        """Start the loop on the page's own device before there is a scene; seconds that took, None if it was stopped.

        Raises: DeviceError.
        """
        from tangible_core import load_method

        options = {name: value for name, value in self.own_device.items() if name != "use"}
        begun_s = time.monotonic()
        with self._lock:
            if self.stopped or self.running:
                return None
            with self._unless_stopped() as stopped:
                self._restart(load_method("device", "pointer")(**options), own_hand=True)
        return None if stopped() else time.monotonic() - begun_s

    def feel(self, felt: LoopInput) -> float | None:
        """Feel a scene, from one tick to the next where the device is the same; seconds that took.

        Returns: None if somebody pressed stop, before or meanwhile: it is then not felt.
        Raises: DeviceError if the device cannot be opened; then nothing is felt.
        """
        begun_s = time.monotonic()
        with self._lock:
            try:
                if self.stopped:
                    return None
                with self._unless_stopped() as stopped:
                    if not self.running or felt.device != self._device:
                        self._restart(felt.device, felt.own_hand)
                    assert self._servo is not None
                    self._servo.swap(felt.touch, felt.safety)
            finally:
                self.felt = felt
                felt.touch.discard()
        return None if stopped() else time.monotonic() - begun_s

    def pull_to(self, beacon: Beacon | None) -> None:
        """Pull the hand to a part of what is felt, or let go of it. Raises: DeviceError if nothing is felt."""
        if beacon is None:
            self._pulling, servo = None, self._servo
            if servo is not None:
                servo.pull_to(None)
            return
        with self._lock:
            servo = self._servo
            if servo is None or not self.running:
                raise DeviceError("nothing is felt, so nothing can be pulled; make and feel a surface first")
            own_hand = self.felt is not None and self.felt.own_hand
            servo.pull_to(beacon, BUTTONS & ~PRESSED if own_hand else BUTTONS)
            self._pulling = servo

    def beacon_over(self) -> str:
        """Why a beacon ended by itself: `button`, `scene` or `ended`, of the loop; said once. To be asked often."""
        servo = self._pulling
        if servo is None or (self.running and servo is self._servo and servo.beacon.part is not None):
            return ""
        self._pulling = None
        return servo.ring.beacon.state.why or "ended"

    def cut(self) -> Callable[[], None]:
        """No force from the next tick on, and none until `allow`. Waits for nothing and nobody.

        Returns: what waits until the loops that there are now are gone, and leaves later ones alone.
        """
        self.stopped, self._stops = True, self._stops + 1
        self._told = self._servo
        self.hand.release()
        cut = [servo for servo in (self._starting, self._servo) if servo is not None]
        for servo in cut:
            with suppress(DeviceError):  # it has no ring yet; what it begins with gives no force
                servo.ring.header[STOP] = 1

        def ended() -> None:
            for servo in cut:
                _end(servo)

        return ended

    def stop(self) -> None:
        """No force, at once, and for good; returns when the loop is gone, but does not wait for one that starts."""
        ended = self.cut()
        self.hand.close()
        ended()

    def allow(self) -> None:
        """Loops may start again."""
        self.stopped = False

    def loop_end(self) -> LoopEnd | None:
        """Why the loop ended, if it did so by itself; said once. To be asked often."""
        servo = self._servo
        if servo is None or servo.running or servo is self._told:
            return None
        self._told = servo
        return None if self.stopped else LoopEnd(_end(servo), servo.lost)

    def frame(self, seq: int, status: int, other_law: OtherLaw = ALONE) -> bytes | None:
        """The newest tick as a STATE; a hand that is nowhere without a loop; None for a tick that was overwritten."""
        servo = self._servo
        if servo is None or not self.running:
            nowhere = *HIGH_M, *UNKNOWN, *NOBODY, *NOBODY, *NOBODY
            return STATE_FRAME.pack(STATE, status, 0, seq & 0xFFFFFFFF, 0, 0, 1e3 * time.time(), *nowhere, 0.0)
        if (row := servo.ring.latest()) is None:
            return None
        t, late, x, y, z, vx, vy, vz, px, py, pz, fx, fy, fz, flags, buttons, _ = row.tolist()
        sample_ms = 1e3 * (servo.ring.start_ns / 1e9 + t + time.time() - time.monotonic())
        tag = int(buttons) >> BUTTON_BITS
        return STATE_FRAME.pack(
            STATE, status, int(flags) & FLAG_BITS, seq & 0xFFFFFFFF, tag, servo.ring.overruns, sample_ms,
            x, y, z, *(UNKNOWN if other_law.blind else (px, py, pz)), fx, fy, fz, vx, vy, vz,
            *other_law.force_n, 1e6 * late,
        )  # fmt: skip

    @contextmanager
    def _unless_stopped(self) -> Iterator[Callable[[], bool]]:
        """What fails because somebody pressed stop did not fail. Gives who can say whether somebody has.

        Who pressed it did not see the loop that came to be meanwhile: that one is ended here.
        """
        before = self._stops

        def stopped() -> bool:
            return self._stops != before

        try:
            yield stopped
        except DeviceError:
            if not stopped():
                raise
        finally:
            if stopped() and self._servo is not None:
                _end(self._servo)

    def _restart(self, device: HapticDevice, own_hand: bool) -> None:
        """Another loop, on this device; it begins without force."""
        self.hand.close()
        before, self._servo, self._device = self._servo, None, None
        if before is not None:
            _end(before)
        self._starting = servo = Servo(still(), device, Safety())
        try:
            servo.__enter__()
            self._servo, self._device = servo, device
        finally:
            self._starting = None
        if own_hand and self.running:
            self.hand.open(placement_of(device))


def without_mapping(device: HapticDevice) -> HapticDevice:
    """What the hand holds."""
    return device.device if isinstance(device, MappedDevice) else device


def _end(servo: Servo) -> str:
    """End it, if it still runs; why it ended."""
    try:
        return servo.stop(STOPPED).stopped
    except TangibleError as error:
        return str(error)
    except Exception as error:  # noqa: BLE001 - what a plugin raised in the loop is no failure of stopping it
        return sentence(error)
