"""An open Falcon: packets out, answers in, and no force left at the end. Imports pyusb and numba."""

import logging
from array import array
from collections.abc import Callable
from contextlib import suppress
from typing import NamedTuple, final

import numpy as np

from tangible_core.compiled import CompiledLink, LinkKernels
from tangible_core.data import NO_FORCE, Force, HapticState
from tangible_core.errors import DeviceError

from .kernels import tick
from .kernels.framing import ANSWERS, DROPPED, receive
from .kernels.packet import GREEN, HOMED, HOMING, RED, SIZE
from .usb.firmware import NULL
from .usb.port import READ_BYTES, REPLUG, Port

log: logging.Logger = logging.getLogger(__name__)
# Shortest time between two packets: USB carries one a millisecond, and more would only queue.
FRAME_S = 0.0009
QUIET, SILENCES = 20, 5
"""Reads without an answer, of a millisecond each, after which the packets in flight count as lost; and the number of
such losses in a row after which the device has failed."""
PATIENCE = 50  # exchanges without a reliable position after which the device has failed
GOODBYES = 3  # null packets at the end: more than one, as one may be lost


class Health(NamedTuple):
    """Counts of the exchange since the device was opened."""

    rate_hz: float  # answers a second, by the device's clock
    answers: int
    lost: int  # packets without an answer
    dropped_bytes: int  # bytes outside of answers
    refused: int  # answers that were not accepted as a position: leaps, and angles that no tip has


@final
class FalconLink(CompiledLink):
    """A Falcon in use, with running firmware; at first it is not homed and gives no force."""

    def __init__(
        self,
        port: Port,
        arms: np.ndarray,
        frame: np.ndarray,
        max_force_n: float,
        clock: Callable[[], float],
        samples: int = 16,
        in_flight: int = 2,
        leds: bool = True,
    ) -> None:
        super().__init__(port.place, max_force_n)
        self._port = port
        self._clock = clock
        self._in_flight = in_flight
        self._packet, self._reply = array("B", NULL), array("B", bytes(READ_BYTES))
        self._chunk, self._rest = np.frombuffer(self._reply, np.uint8), np.zeros(SIZE, np.uint8)
        self._buffers = tick.Buffers(
            answer=np.zeros(SIZE, np.uint8),
            packet=np.frombuffer(self._packet, np.uint8),
            counts=np.zeros(tick.COUNTS, np.int64),
            held=np.zeros(tick.HELD),
            history=np.zeros((samples, 4)),
            arms=arms,
            frame=frame,
        )
        self._counts, self._memory = self._buffers.counts, self._buffers.held
        self._counts[tick.SEEKING], self._counts[tick.RUNNING] = HOMING | leds * RED, HOMING | leds * GREEN
        self._state = np.zeros(7)
        self._pending = self._losses = self._silences = 0
        self._started_s = clock()
        self._sent_s = self._started_s - 1.0
        tick.write(*self._buffers, 0.0, 0.0, 0.0)

    def kernels(self) -> LinkKernels:
        """Return the kernels on this link's buffers."""
        return LinkKernels(tick.read, tick.write, tuple(self._buffers))

    @property
    def exchanges(self) -> bool:
        """True: packets travel by USB, which Python controls."""
        return True

    @property
    def place(self) -> str:
        """The device's name and place, for messages."""
        return self._port.place

    @property
    def is_homed(self) -> bool:
        """True if all arms have found their zero, by the newest answer, and force has faded in since."""
        counts, held = self._counts, self._memory
        return bool(counts[tick.KNOWN] and held[tick.NOW] - held[tick.SINCE] >= tick.RAMP_S)

    @property
    def arms_homed(self) -> int:
        """Number of arms, of three, that have found their zero, by the newest answer read."""
        return int(self._counts[tick.ARMS] & HOMED).bit_count()

    def health(self) -> Health:
        """Return the counts of the exchange so far."""
        counts, seconds = self._counts, self._clock() - self._started_s
        answers = int(counts[ANSWERS])
        rate_hz = answers / seconds if seconds > 0 else 0.0
        return Health(rate_hz, answers, self._losses, int(counts[DROPPED]), int(counts[tick.REFUSED]))

    def look(self) -> bool:
        """Read the newest answer; tell whether it is new and gives a position."""
        return bool(tick.read(*self._buffers, self._state))

    def _read(self) -> HapticState:
        """Return the position of a new answer; send packets until there is one. Raises: DeviceError."""
        for _ in range(PATIENCE):
            if self.look():
                x, y, z, vx, vy, vz, buttons = self._state.tolist()
                return HapticState((x, y, z), (vx, vy, vz), float(self._memory[tick.NOW]), int(buttons))
            self._exchange()
        raise self._give_up(
            DeviceError(f"{self._port.place}: lost its homing or sends invalid data; open it again, and home it")
        )

    def _send(self, force: Force) -> None:
        tick.write(*self._buffers, *force)
        self._exchange()

    @property
    def applied(self) -> Force:
        """The force that the device holds: the force written, as far as its motors can give it."""
        x, y, z = self._memory[tick.APPLIED : tick.APPLIED + 3].tolist()
        return Force(x, y, z)

    def _exchange(self) -> None:
        try:
            while self._clock() - self._sent_s < FRAME_S:
                self._fetch()
            self._port.write(self._packet)
            self._sent_s = self._clock()
            self._pending += 1
            self._receive()
        except DeviceError as error:
            raise self._give_up(error) from error

    def _release(self) -> None:
        # Null packets, with an answer to each, so that none is left in flight.
        health, self._in_flight = self.health(), 1
        try:
            for _ in range(GOODBYES):
                self._port.write(array("B", NULL))
                self._pending += 1
                self._receive()
        except DeviceError as error:
            log.warning("its force could not be made zero, turn off its power: %s", error)
        self._let_go()
        log.info("%s: %s", self._port.place, health)

    def _receive(self) -> None:
        """Read until fewer packets than allowed are in flight; without an answer, all are lost. Raises: DeviceError."""
        quiet = 0
        while self._pending >= self._in_flight:
            if self._fetch():
                self._silences = quiet = 0
            elif (quiet := quiet + 1) == QUIET:
                self._losses += self._pending
                self._pending = 0
                self._silences += 1
        if self._silences == SILENCES:
            raise DeviceError(f"{self._port.place}: no longer answers; {REPLUG}")

    def _fetch(self) -> int:
        """Make one IN transfer, of a millisecond if the chip has nothing; return the number of answers."""
        size = self._port.read(self._reply)
        answers = receive(self._chunk, size, self._rest, self._counts, self._buffers.answer)
        if answers:
            self._memory[tick.NOW] = self._clock()
            self._pending = max(self._pending - answers, 0)
        return answers

    def _give_up(self, error: DeviceError) -> DeviceError:
        """Stop the motors, if they still listen, and close the port; return the error."""
        with suppress(DeviceError):
            self._port.write(array("B", NULL))
        self._let_go()
        self._end(f"was closed after an error: {error}")
        return error

    def _let_go(self) -> None:
        self._memory[tick.APPLIED : tick.APPLIED + 3] = NO_FORCE
        self._counts[tick.KNOWN] = 0
        self._port.close()
