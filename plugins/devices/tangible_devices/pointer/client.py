"""The client of a pointer device: the program that moves it."""

import math
import time
from itertools import count
from typing import Self, final

from tangible_core.data import NO_FORCE, Force, Vector
from tangible_core.errors import DeviceAbsent, DeviceError
from tangible_core.servo import POINTER_DEVICE_SILENCE_S

from .channel import (
    CLIENT_OPEN,
    DEVICE_OPEN,
    FORCE,
    FORCE_WORDS,
    MAGIC,
    MARK,
    SAMPLE,
    SAMPLE_WORDS,
    Channel,
    device_is_open,
)


@final
class PointerClient:
    """A client that moves a `pointer` device and reads its forces; a context manager, for one thread at a time.

    Send at least every tenth of a second, also when nothing moves: a silent client counts as gone. To let go, call
    `release`. Needs no numba.

        with PointerClient() as client:
            client.send((0.01, 0.0, 0.005))
            force = client.force()
    """

    def __init__(self, channel: str = "pointer", wait_s: float = 0.0) -> None:
        """Become the client of a channel, waiting up to wait_s for its device. Raises: DeviceError."""
        self._name = channel
        _await_device(channel, wait_s)
        self._channel = Channel(channel, "client")
        if self._channel.memory[MAGIC * 8 : MAGIC * 8 + 8] != MARK:
            self._channel.close()
            raise DeviceError(f"pointer {channel!r}: {self._channel.path} is of another version; install the same one")
        before = self._channel.take(SAMPLE, SAMPLE_WORDS)
        self._numbers = count(1 + (before[0] if before else time.monotonic_ns()))
        self._last: tuple[float, Vector] | None = None
        self._last_force = (-1, time.monotonic())
        self._open, self._is_free = True, False

    def send(self, position_m: Vector, buttons: int = 0, velocity_m_per_s: Vector | None = None) -> None:
        """Send the position of the tip; by default with the mean velocity since the last call. Raises: DeviceError."""
        self._check_open()
        now = time.monotonic()
        velocity = velocity_m_per_s or self._velocity(now, position_m)
        values = (*map(float, position_m), *map(float, velocity), float(buttons))
        if len(values) != SAMPLE_WORDS - 1 or not all(map(math.isfinite, values)):
            raise DeviceError(
                f"a pointer takes a position of three finite numbers in metres, not {position_m}, at {velocity_m_per_s}"
            )
        self._last = now, position_m
        self._channel.put(SAMPLE, next(self._numbers), values)
        self._channel.set_flag(CLIENT_OPEN, True)
        self._is_free = False

    def release(self) -> None:
        """Let go of the pointer until the next `send`, which starts anew, unfiltered; no force acts meanwhile."""
        if self._open:
            self._channel.set_flag(CLIENT_OPEN, False)
            self._last, self._is_free = None, True

    def force(self) -> Force:
        """Return the force on the hand; zero if the device is silent, or after `release`. Raises: DeviceError."""
        self._check_open()
        now = time.monotonic()
        block = self._channel.take(FORCE, FORCE_WORDS)
        if block is not None and block[0] != self._last_force[0]:
            self._last_force = block[0], now
        if block is None or self._is_free or now - self._last_force[1] > POINTER_DEVICE_SILENCE_S:
            return NO_FORCE
        return Force(*block[1])

    def close(self) -> None:
        """Leave the channel; the tip is then high above the surface. A second call does nothing."""
        if self._open:
            self.release()
            self._open = False
            self._channel.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _velocity(self, now: float, position_m: Vector) -> Vector:
        then, (x, y, z) = self._last or (now, position_m)
        span = now - then
        if span <= 0:
            return 0.0, 0.0, 0.0
        return (position_m[0] - x) / span, (position_m[1] - y) / span, (position_m[2] - z) / span

    def _check_open(self) -> None:
        if not self._open:
            raise DeviceError(f"this client of pointer {self._name!r} is closed; make another")
        if not self._channel.flag(DEVICE_OPEN):
            raise DeviceError(f"the device of pointer {self._name!r} was closed; start it again, then connect again")


def _await_device(channel: str, wait_s: float) -> None:
    end = time.monotonic() + wait_s
    while not device_is_open(channel):
        if time.monotonic() >= end:
            raise DeviceAbsent(
                f"no device is open on pointer {channel!r}; start `tangible feel` with `device: {{use: pointer}}` first"
            )
        time.sleep(0.02)
