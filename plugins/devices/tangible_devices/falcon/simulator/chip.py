"""The FTDI chip of a simulated Falcon: rates, modem lines, the latency timer, 2 status bytes a packet; its clocks."""

import math
import time
from collections.abc import Callable
from typing import final

from .processor import Processor

FRAME_S = 0.001
STATUS = bytes([0x01, 0x60])
PACKET_BYTES = 64
PAYLOAD_BYTES = PACKET_BYTES - len(STATUS)
Spoil = Callable[[int, bytes], bytes]


class SimulatedClock:
    """A clock of seconds since the start, which advances only when it is waited for."""

    def __init__(self) -> None:
        self._now_s = 0.0

    def __call__(self) -> float:
        """Return the last moment that was waited for."""
        return self._now_s

    def wait_until(self, moment_s: float) -> None:
        """Set the time to this moment, unless it has passed."""
        self._now_s = max(self._now_s, moment_s)


class RealClock(SimulatedClock):
    """A clock of real time."""

    def __init__(self) -> None:
        self._start_s = time.perf_counter()

    def __call__(self) -> float:
        """Return the seconds since this clock was created."""
        return time.perf_counter() - self._start_s

    def wait_until(self, moment_s: float) -> None:
        """Sleep until then."""
        if (left_s := moment_s - self()) > 0:
            time.sleep(left_s)


class StallError(Exception):
    """A request that the chip does not support."""


@final
class Chip:
    """The chip between USB and the processor. Faults: `spoil(bytes_before, data)` and `delay(replies_before)`, s."""

    def __init__(
        self,
        processor: Processor,
        clock: SimulatedClock,
        spoil: Spoil = lambda _, data: data,
        delay: Callable[[int], float] = lambda _: 0.0,
    ) -> None:
        self.processor = processor
        self._clock = clock
        self._spoil, self._delay = spoil, delay
        self._divisor, self._latency_s, self._dtr, self._event = 0, 0.016, False, -1
        self._line_free_s = 0.0
        self._waiting: list[tuple[float, bytes]] = []
        self._reply_bytes = self._replies = 0

    def control(self, request: int, value: int) -> None:
        """Execute a vendor request. Raises: StallError if the chip does not support it."""
        if request == 0:
            if value != 2:  # purge what was received; 0 resets all
                self._waiting.clear()
        elif request == 1:
            if value & 0x0100:
                before, self._dtr = self._dtr, bool(value & 1)
                if self._dtr and not before:
                    self.processor.reset()
        elif request == 3:
            self._divisor = value
        elif request == 6:
            self._event = value & 0xFF if value & 0x0100 else -1
        elif request == 9:
            self._latency_s = value / 1000
        elif request not in (2, 4):
            raise StallError

    def write(self, data: bytes) -> None:
        """Send bytes to the processor; its reply is ready after both transfers on the wire, and the latency timer."""
        now_s = self._clock()
        rate = 3e6 / (self._divisor & 0x3FFF or 1)
        heard_s = max(now_s, self._line_free_s) + 10 * len(data) / rate
        self._line_free_s = heard_s
        reply = self._spoil(self._reply_bytes, self.processor.hear(data, self._divisor, self._dtr, now_s))
        if not reply:
            return
        self._reply_bytes += len(reply)
        arrived_s = heard_s + 10 * len(reply) / rate
        at_once = len(reply) % PAYLOAD_BYTES == 0 or reply[-1] == self._event
        ready_s = arrived_s + (0.0 if at_once else self._latency_s) + self._delay(self._replies)
        self._replies += 1
        self._waiting.append((FRAME_S * math.ceil(ready_s / FRAME_S - 1e-9), reply))

    def read(self, most: int) -> bytes:
        """Make one IN transfer: the data ready by the timer's end in packets of 64 bytes, or the status alone."""
        now_s = self._clock()
        timer_s = self._latency_s * (math.floor(now_s / self._latency_s + 1e-9) + 1)
        first_s = min((ready_s for ready_s, _ in self._waiting), default=timer_s)
        self._clock.wait_until(min(first_s, timer_s))
        payload = self._ready(most // PACKET_BYTES * PAYLOAD_BYTES)
        parts = [payload[at : at + PAYLOAD_BYTES] for at in range(0, len(payload), PAYLOAD_BYTES)]
        return b"".join(STATUS + part for part in parts) or STATUS

    def _ready(self, most: int) -> bytes:
        now_s = self._clock()
        payload = b""
        while self._waiting and self._waiting[0][0] <= now_s and len(payload) < most:
            _, reply = self._waiting.pop(0)
            payload, rest = payload + reply[: most - len(payload)], reply[most - len(payload) :]
            if rest:
                self._waiting.insert(0, (0.0, rest))
        return payload
