"""The force loop as the page's server has it: started before there is a scene, swapped, watched. No numba here."""

import pickle
import time
from pathlib import Path
from threading import Lock
from typing import Any, NamedTuple, final

from tangible_core.data import Vector
from tangible_core.mapping import WorkspaceMapping
from tangible_core.plugins.interfaces import HapticDevice
from tangible_core.servo import Packed, Safety, Servo, still

from .hand import Hand
from .wire import BUTTON_BITS, STATE, STATE_FRAME

NOBODY: Vector = (0.0, 0.0, 0.0)
STALE_AFTER_S = 0.3
"""The server's own silence, after which the loop lets go of the page's hand: a machine that starts a browser keeps it
waiting for a quarter of a second. A page's silence is `hand.SILENT_S`."""
FOLLOW_S = 0.012
"""A mouse moves 60 times a second, the loop looks a thousand times: the hand follows smoothly."""


class Felt(NamedTuple):
    """What the maker made, as the loop needs it."""

    touch: Packed
    law: str
    device_name: str
    device: HapticDevice
    """As the picture sees it, by the mapping."""
    own_hand: bool
    """Whether that is the page's own pointer."""
    mapping: WorkspaceMapping
    safety: Safety

    @classmethod
    def of(cls, made: dict[str, Any], own_hand: bool) -> "Felt":
        """From the maker's answer."""
        touch = Packed(Path(made["parcel"]), made["stiffness_n_per_m"])
        parts = (pickle.loads(made[name]) for name in ("device", "mapping", "safety"))
        device, mapping, safety = parts
        return cls(touch, made["law"], made["device_name"], device, own_hand, mapping, safety)


@final
class Feeling:
    """One force loop at a time, and the page's hand in it. What takes long blocks: call it in a thread."""

    def __init__(self, channel: str) -> None:
        """channel: of the page's own pointer device."""
        self.channel = channel
        self.hand = Hand(channel)
        self.felt: Felt | None = None
        self._servo: Servo | None = None
        self._device: HapticDevice | None = None
        self._lock = Lock()

    @property
    def own_device(self) -> dict[str, Any]:
        """The page's own device, as a pipeline file says it."""
        return {"use": "pointer", "channel": self.channel, "stale_after_s": STALE_AFTER_S, "follow_s": FOLLOW_S}

    @property
    def servo(self) -> Servo | None:
        """The loop; None before the first."""
        return self._servo

    @property
    def running(self) -> bool:
        """Whether forces are given."""
        return self._servo is not None and self._servo.running

    @property
    def how(self) -> str:
        """What the operating system granted the loop."""
        return "" if self._servo is None else self._servo.how

    def start(self) -> float:
        """Start the loop on the page's own device before there is a scene; seconds that took. Raises: DeviceError."""
        from tangible_core import load_method

        options = {name: value for name, value in self.own_device.items() if name != "use"}
        with self._lock:
            return self._restart(load_method("device", "pointer")(**options), own_hand=True)

    def feel(self, felt: Felt) -> float:
        """Feel a scene, from one tick to the next where the device is the same; seconds that took.

        Raises: DeviceError if the device cannot be opened.
        """
        begun_s = time.monotonic()
        with self._lock:
            if not self.running or felt.device != self._device:
                self._restart(felt.device, felt.own_hand)
            self.hand.mapping = felt.mapping
            assert self._servo is not None
            self._servo.swap(felt.touch, felt.safety)
            self.felt = felt
        return time.monotonic() - begun_s

    def stop(self) -> None:
        """No force, at once."""
        self.hand.close()
        with self._lock:
            if self._servo is not None:
                self._servo.stop()

    def frame(self, seq: int, status: int) -> bytes | None:
        """The newest tick as a STATE; None before the first."""
        servo = self._servo
        if servo is None or (row := servo.ring.latest()) is None:
            return None
        t, late, x, y, z, vx, vy, vz, px, py, pz, fx, fy, fz, flags, buttons = row.tolist()
        sample_ms = 1e3 * (servo.ring.start_ns / 1e9 + t + time.time() - time.monotonic())
        tag = int(buttons) >> BUTTON_BITS
        return STATE_FRAME.pack(
            STATE, status, int(flags), seq & 0xFFFFFFFF, tag, servo.ring.overruns, sample_ms,
            x, y, z, px, py, pz, fx, fy, fz, vx, vy, vz, *NOBODY, 1e6 * late,
        )  # fmt: skip

    def _restart(self, device: HapticDevice, own_hand: bool) -> float:
        begun_s = time.monotonic()
        self.hand.close()
        if self._servo is not None:
            self._servo.stop()
        servo = Servo(still(), device, Safety())
        servo.__enter__()
        self._servo, self._device = servo, device
        if own_hand:
            self.hand.open()
        return time.monotonic() - begun_s
