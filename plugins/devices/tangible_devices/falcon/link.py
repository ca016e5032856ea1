"""An open Falcon: packets out, answers in, and no force left behind. Imports pyusb and numba."""

import logging
from array import array
from collections.abc import Callable
from contextlib import suppress
from typing import NamedTuple, final

import numpy as np

from tangible_core.compiled.touch import CompiledLink, LinkKernels
from tangible_core.data import NO_FORCE, Force, HapticState
from tangible_core.errors import DeviceError

from .kernels import tick
from .kernels.framing import ANSWERS, DROPPED, receive
from .kernels.packet import GREEN, HOMED, HOMING, RED, SIZE
from .usb.errors import REPLUG
from .usb.firmware import NULL
from .usb.port import READ_BYTES, Port

log = logging.getLogger(__name__)
FRAME_S = 0.0009
"""Sooner than this no other packet is sent: USB moves one a millisecond, and more of them only wait in line."""
QUIET, SILENCES = 20, 5
"""Reads without an answer, each of a millisecond, after which the packets on their way are lost; how often in a row
this may be."""
PATIENCE = 50
"""Exchanges without a position that can be trusted, after which the device has failed."""
GOODBYES = 3
"""Null packets at the end, as one may be lost."""


class Health(NamedTuple):
    """How the exchange went since the device was opened."""

    rate_hz: float
    """Answers a second, over the device's clock."""
    answers: int
    lost: int
    """Packets that were never answered."""
    dropped_bytes: int
    """Bytes that belong to no answer."""
    refused: int
    """Answers that were not taken for a position: leaps, and angles that no tip has."""


@final
class FalconLink(CompiledLink):
    """A Falcon in use, its firmware running; not homed at first, and so without force."""

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
        self._sent, self._received = array("B", NULL), array("B", bytes(READ_BYTES))
        self._chunk, self._begun = np.frombuffer(self._received, np.uint8), np.zeros(SIZE, np.uint8)
        self._buffers = tick.Buffers(
            answer=np.zeros(SIZE, np.uint8),
            packet=np.frombuffer(self._sent, np.uint8),
            counts=np.zeros(tick.COUNTS, np.int64),
            held=np.zeros(tick.HELD),
            history=np.zeros((samples, 4)),
            arms=arms,
            frame=frame,
        )
        self._counts, self._held = self._buffers.counts, self._buffers.held
        self._counts[tick.SEEKING], self._counts[tick.RUNNING] = HOMING | leds * RED, HOMING | leds * GREEN
        self._state = np.zeros(7)
        self._pending = self._lost = self._silences = 0
        self._started_s = clock()
        self._sent_s = self._started_s - 1.0
        tick.write(*self._buffers, 0.0, 0.0, 0.0)

    def kernels(self) -> LinkKernels:
        """The kernels on this link's buffers."""
        return LinkKernels(tick.read, tick.write, tuple(self._buffers))

    @property
    def exchanges(self) -> bool:
        """Packets travel by USB, which Python asks for."""
        return True

    @property
    def place(self) -> str:
        """How a message names the device."""
        return self._port.place

    @property
    def homed(self) -> bool:
        """Whether all arms have found their zero, by the newest answer, and force has faded in since."""
        counts, held = self._counts, self._held
        return bool(counts[tick.KNOWN] and held[tick.NOW] - held[tick.SINCE] >= tick.RAMP_S)

    @property
    def arms_homed(self) -> int:
        """How many of the three arms have found their zero, by the newest answer read."""
        return int(self._counts[tick.ARMS] & HOMED).bit_count()

    def health(self) -> Health:
        """How the exchange went so far."""
        counts, seconds = self._counts, self._clock() - self._started_s
        answers = int(counts[ANSWERS])
        rate_hz = answers / seconds if seconds > 0 else 0.0
        return Health(rate_hz, answers, self._lost, int(counts[DROPPED]), int(counts[tick.REFUSED]))

    def look(self) -> bool:
        """Take in the newest answer; whether it is a new one, and gives a position."""
        return bool(tick.read(*self._buffers, self._state))

    def _read(self) -> HapticState:
        """The newest position, of an answer that was not read before; a packet is sent for one if need be.

        Raises: DeviceError if the device stopped answering or lost its homing.
        """
        for _ in range(PATIENCE):
            if self.look():
                x, y, z, vx, vy, vz, buttons = self._state.tolist()
                return HapticState((x, y, z), (vx, vy, vz), float(self._held[tick.NOW]), int(buttons))
            self._exchange()
        raise self._given_up(
            DeviceError(f"{self._port.place}: lost its homing or sends no sense; open it again, and home it")
        )

    def _send(self, force: Force) -> None:
        """Send a force at once and fetch the answer. Raises: DeviceError if the device stopped answering."""
        tick.write(*self._buffers, *force)
        self._exchange()

    @property
    def applied(self) -> Force:
        """The force that the device holds: what was written, less what its motors cannot give."""
        x, y, z = self._held[tick.APPLIED : tick.APPLIED + 3].tolist()
        return Force(x, y, z)

    def _exchange(self) -> None:
        """Send the packet, and wait while as many are on their way as may be."""
        try:
            while self._clock() - self._sent_s < FRAME_S:
                self._fetch()
            self._port.write(self._sent)
            self._sent_s = self._clock()
            self._pending += 1
            self._receive()
        except DeviceError as error:
            raise self._given_up(error) from error

    def _release(self) -> None:
        """Send null packets and let go."""
        health = self.health()
        try:
            self._say_goodbye()
        except DeviceError as error:
            log.warning("its force could not be made zero, turn off its power: %s", error)
        self._let_go()
        log.info("%s: %s", self._port.place, health)

    def _receive(self) -> None:
        """Read until fewer packets are on their way than may be. All of them are lost when nothing comes.

        Raises: DeviceError if this happens again and again, or USB fails.
        """
        quiet = 0
        while self._pending >= self._in_flight:
            if self._fetch():
                self._silences = quiet = 0
            elif (quiet := quiet + 1) == QUIET:
                self._lost += self._pending
                self._pending = 0
                self._silences += 1
        if self._silences == SILENCES:
            raise DeviceError(f"{self._port.place}: answers no more; {REPLUG}")

    def _fetch(self) -> int:
        """One IN transfer, which takes a millisecond if the chip has nothing; how many answers it brought."""
        size = self._port.read(self._received)
        found = receive(self._chunk, size, self._begun, self._counts, self._buffers.answer)
        if found:
            self._held[tick.NOW] = self._clock()
            self._pending = max(self._pending - found, 0)
        return found

    def _say_goodbye(self) -> None:
        """Null packets, each waited for, so that nothing is left on its way."""
        null = array("B", NULL)
        self._in_flight = 1
        for _ in range(GOODBYES):
            self._port.write(null)
            self._pending += 1
            self._receive()

    def _given_up(self, error: DeviceError) -> DeviceError:
        """The error, after the motors were told to stop, as far as they still listen, and the port was given back."""
        with suppress(DeviceError):
            self._port.write(array("B", NULL))
        self._let_go()
        self._end(f"was closed after an error: {error}")
        return error

    def _let_go(self) -> None:
        self._held[tick.APPLIED : tick.APPLIED + 3] = NO_FORCE
        self._counts[tick.KNOWN] = 0
        self._port.close()
