"""A device that is moved by another program: a mouse, a robot, a test."""

import math
import time
from dataclasses import replace
from types import ModuleType
from typing import Annotated, Any, final

import numpy as np
from pydantic import Field

from tangible_core.compiled.touch import CompiledLink, LinkKernels
from tangible_core.data import NO_FORCE, DeviceSpec, Force, HapticState, Vector
from tangible_core.plugins.interfaces import Attended, HapticDevice, Link

from ..simulated import LIKE_A_FALCON
from .channel import DEVICE_OPEN, FORCE, FORCE_WORDS, MAGIC, MARK, SAMPLE, SAMPLE_WORDS, Channel, client_is_there

HIGH_M = (0.0, 0.0, 1.0)
"""Where the tip is without a client: above every surface."""
PACE_S = 0.0005
PERIOD_S = 0.001
"""Of a compiled loop."""


class Pointer(HapticDevice, Attended):
    """Moved by another program through shared memory, which is shown the forces: no motor, real time.

    A program that moves it is a `PointerClient`; `tangible pointer` is one. Without one, and when it falls silent, the
    tip is high above the surface, where nothing is felt. One device and one client at a time on a channel. Its limits
    are a Novint Falcon's, so that what is shown is what a Falcon would do.
    """

    channel: Annotated[str, Field(pattern=r"^[a-z0-9][a-z0-9-]{0,63}$")] = "pointer"
    """Name of the shared memory, the same for device and client."""
    stale_after_s: Annotated[float, Field(ge=0.002, le=10)] = 0.1
    """Silence after which the client's position is no longer used; a compiled loop counts it in ticks of 1 ms. Longer
    for a client that a busy machine may hold up; the force then stays for as long, should it die."""
    follow_s: Annotated[float, Field(ge=0, le=1)] = 0.0
    """Time constant with which the tip follows the client's positions and velocities: with 12 ms those of a mouse, 60 a
    second, make a smooth path and no stairs. 0 takes them as they come. A compiled loop counts it in ticks of 1 ms."""

    def spec(self) -> DeviceSpec:
        """A Novint Falcon's force, stiffness and damping; the workspace is whatever the client has."""
        return replace(LIKE_A_FALCON, workspace_m=(1.0, 1.0, 1.0), buttons=31)

    def unattended(self) -> str | None:
        """Whether nobody moves it."""
        if client_is_there(self.channel):
            return None
        channel = "" if self.channel == "pointer" else f" --channel {self.channel}"
        return f"nobody moves the pointer, so nothing is felt; start `tangible pointer{channel}` in another terminal"

    def open(self) -> Link:
        """Raises: DeviceError if this channel has a device already, or its file cannot be made."""
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
        self._held = self._words[FORCE + 1 : FORCE + FORCE_WORDS].view(np.float64)
        self._kept = np.zeros(kernels.KEPT_WORDS, np.uint64)
        self._numbers = self._kept.view(np.float64)
        self._stale_after_s, self._follow_s = stale_after_s, follow_s
        self._numbers[kernels.SHARE] = -math.expm1(-PERIOD_S / follow_s) if follow_s else 1.0
        self._last = self._words[SAMPLE]  # what lies there from before is nobody's
        self._kept[kernels.LAST] = self._last
        self._kept[kernels.AGE] = self._kept[kernels.OLDEST] = round(stale_after_s * 1000)
        self._heard_s, self._read_s = -math.inf, 0.0
        self._sample = self._tip = HapticState(HIGH_M)
        self._send(NO_FORCE)
        self._words[MAGIC] = np.frombuffer(MARK, np.uint64)[0]
        self._words[DEVICE_OPEN] = 1

    def _read(self) -> HapticState:
        """Where the client is; high above where there is none.

        Waits until half a millisecond after the read before, so that a loop without a clock of its own does not spin.
        """
        time.sleep(max(0.0, self._read_s + PACE_S - time.monotonic()))
        now = time.monotonic()
        passed_s, self._read_s = now - self._read_s, now
        found = self._code.fetch(self._words, self._kept)
        if found == self._code.WHOLE and self._kept[0] != self._last:
            x, y, z, vx, vy, vz, buttons = self._numbers[1:SAMPLE_WORDS].tolist()
            self._sample = HapticState((x, y, z), (vx, vy, vz), now, int(buttons))
            if now - self._heard_s > self._stale_after_s:
                self._tip = self._sample
            self._last, self._heard_s = self._kept[0], now
        if found == self._code.NOBODY:
            self._heard_s = -math.inf
        if now - self._heard_s > self._stale_after_s:
            return HapticState(HIGH_M, time_s=now)
        share = -math.expm1(-passed_s / self._follow_s) if self._follow_s else 1.0
        self._tip = _towards(self._tip, self._sample, share)
        return self._tip._replace(time_s=now)

    def _send(self, force: Force) -> None:
        """Show this force until the next one."""
        self._code.write(self._words, self._kept, self._numbers, *force)

    @property
    def applied(self) -> Force:
        """The force that the client is shown."""
        return Force(*self._held.tolist())

    def _release(self) -> None:
        """Leave the channel to another device."""
        self._words[DEVICE_OPEN] = 0
        self._channel.close()

    def kernels(self) -> LinkKernels:
        """Read and write on the shared memory itself."""
        return LinkKernels(self._code.read, self._code.write, (self._words, self._kept, self._numbers))

    @property
    def exchanges(self) -> bool:
        """No: the client fills and empties the memory."""
        return False

    def _exchange(self) -> None:
        """Nothing has to travel."""


def _towards(tip: HapticState, sample: HapticState, share: float) -> HapticState:
    """The sample, with the tip so far on its way there."""
    if share >= 1.0:
        return sample
    return sample._replace(
        position_m=_part(tip.position_m, sample.position_m, share),
        velocity_m_per_s=_part(tip.velocity_m_per_s, sample.velocity_m_per_s, share),
    )


def _part(here: Vector, there: Vector, share: float) -> Vector:
    x, y, z = (a + share * (b - a) for a, b in zip(here, there, strict=True))
    return x, y, z
