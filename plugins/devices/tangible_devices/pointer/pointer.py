"""A device that another program moves, for a mouse, a robot or a test."""

import math
import time
from dataclasses import replace
from types import ModuleType
from typing import Annotated, Any, final

import numpy as np
from pydantic import Field

from tangible_core.compiled import CompiledLink, LinkKernels
from tangible_core.data import NO_FORCE, DeviceSpec, Force, HapticState, Vector
from tangible_core.plugins import Attended, HapticDevice, Link
from tangible_core.servo import POINTER_SILENCE_S

from ..simulated import LIKE_A_FALCON
from .channel import DEVICE_OPEN, FORCE, FORCE_WORDS, MAGIC, MARK, SAMPLE, SAMPLE_WORDS, Channel, client_is_there

HIGH_M = (0.0, 0.0, 1.0)  # position of the tip without a client: above every surface
PACE_S = 0.0005  # shortest time between two reads from Python
PERIOD_S = 0.001


class Pointer(HapticDevice, Attended):
    """A device that another program moves through shared memory, and whose forces it reads: no motor, real time.

    The other program is a `PointerClient`, such as `tangible pointer`. Without one, and when it is silent, the tip is
    high above the surface, where there is no force. One device and one client at a time on a channel. Its limits are a
    Novint Falcon's, so that the forces are those of a Falcon.
    """

    channel: Annotated[str, Field(pattern=r"^[a-z0-9][a-z0-9-]{0,63}$")] = "pointer"
    """Name of the shared memory, the same for device and client."""
    stale_after_s: Annotated[float, Field(ge=0.002, le=10)] = POINTER_SILENCE_S
    """Silence after which the client's position is no longer used; a compiled loop counts it in ticks of 1 ms. Choose
    more if a busy machine delays the client; the force of a client that dies then stays for as long."""
    follow_s: Annotated[float, Field(ge=0, le=1)] = 0.0
    """Time constant of a filter on the client's positions and velocities: with 12 ms, a mouse's 60 positions a second
    make a smooth path without steps. 0 switches the filter off. A compiled loop counts it in ticks of 1 ms."""

    def spec(self) -> DeviceSpec:
        """Return a Novint Falcon's force, stiffness and damping; the workspace is the client's, 1 m here."""
        return replace(LIKE_A_FALCON, workspace_m=(1.0, 1.0, 1.0), buttons=31)

    def follows(self, channel: str) -> bool:
        """Return True for its own channel."""
        return channel == self.channel

    def unattended(self) -> str | None:
        """Return a message if there is no client, otherwise None."""
        if client_is_there(self.channel):
            return None
        channel = "" if self.channel == "pointer" else f" --channel {self.channel}"
        return f"nothing moves the pointer, so there is no force; start `tangible pointer{channel}` in another terminal"

    def open(self) -> Link:
        """Open the channel. Raises: DeviceError if it has a device already, or its file cannot be created."""
        from . import kernels

        channel = Channel(self.channel, "device")
        return PointerLink(kernels, channel, self.stale_after_s, self.spec().max_force_n, self.follow_s)


@final
class PointerLink(CompiledLink):
    """A pointer in use."""

    def __init__(
        self, kernels: ModuleType, channel: Channel, stale_after_s: float, max_force_n: float, follow_s: float = 0.0
    ) -> None:
        super().__init__("the pointer device", max_force_n)
        channel.set_flag(DEVICE_OPEN, False)  # a device that was killed has left it set
        self._code: Any = kernels
        self._channel = channel
        self._words = np.frombuffer(channel.memory, np.uint64)
        self._force_words = self._words[FORCE + 1 : FORCE + FORCE_WORDS].view(np.float64)
        self._memory = np.zeros(kernels.KEPT_WORDS, np.uint64)
        self._numbers = self._memory.view(np.float64)
        self._stale_after_s, self._follow_s = stale_after_s, follow_s
        self._numbers[kernels.SHARE] = -math.expm1(-PERIOD_S / follow_s) if follow_s else 1.0
        self._last = self._words[SAMPLE]  # what lies there from before is nobody's
        self._memory[kernels.LAST] = self._last
        self._memory[kernels.AGE] = self._memory[kernels.OLDEST] = round(stale_after_s * 1000)
        self._heard_s, self._read_s = -math.inf, 0.0
        self._sample = self._tip = HapticState(HIGH_M)
        self._send(NO_FORCE)
        self._words[MAGIC] = np.frombuffer(MARK, np.uint64)[0]
        self._words[DEVICE_OPEN] = 1

    def _read(self) -> HapticState:
        # Half a millisecond after the last read, so that a loop without its own clock does not spin.
        time.sleep(max(0.0, self._read_s + PACE_S - time.perf_counter()))
        now = time.perf_counter()
        passed_s, self._read_s = now - self._read_s, now
        status = self._code.fetch(self._words, self._memory)
        if status == self._code.WHOLE and self._memory[0] != self._last:
            x, y, z, vx, vy, vz, buttons = self._numbers[1:SAMPLE_WORDS].tolist()
            self._sample = HapticState((x, y, z), (vx, vy, vz), now, int(buttons))
            if now - self._heard_s > self._stale_after_s:
                self._tip = self._sample
            self._last, self._heard_s = self._memory[0], now
        if status == self._code.NOBODY:
            self._heard_s = -math.inf
        if now - self._heard_s > self._stale_after_s:
            return HapticState(HIGH_M, time_s=now)
        share = -math.expm1(-passed_s / self._follow_s) if self._follow_s else 1.0
        self._tip = _towards(self._tip, self._sample, share)
        return self._tip._replace(time_s=now)

    def _send(self, force: Force) -> None:
        self._code.write(self._words, self._memory, self._numbers, *force)

    @property
    def applied(self) -> Force:
        """The force that the client reads."""
        return Force(*self._force_words.tolist())

    def _release(self) -> None:
        self._words[DEVICE_OPEN] = 0
        self._channel.close()

    def kernels(self) -> LinkKernels:
        """Return the kernels on the shared memory."""
        return LinkKernels(self._code.read, self._code.write, (self._words, self._memory, self._numbers))

    @property
    def exchanges(self) -> bool:
        """False: device and client share the memory, and nothing is sent."""
        return False

    def _exchange(self) -> None:
        """Do nothing, as the memory is shared."""


def _towards(tip: HapticState, sample: HapticState, share: float) -> HapticState:
    """Return the sample with the tip moved by this share of its way to it."""
    if share >= 1.0:
        return sample
    return sample._replace(
        position_m=_interpolate(tip.position_m, sample.position_m, share),
        velocity_m_per_s=_interpolate(tip.velocity_m_per_s, sample.velocity_m_per_s, share),
    )


def _interpolate(here: Vector, there: Vector, share: float) -> Vector:
    x, y, z = (a + share * (b - a) for a, b in zip(here, there, strict=True))
    return x, y, z
