"""Loading a Falcon's firmware: the boot loader echoes every byte, and every echo is compared. Imports pyusb."""

import logging
from array import array
from collections.abc import Callable

import numpy as np

from tangible_core.errors import DeviceError

from ..kernels.framing import COUNTS, USB_PACKET, receive
from ..kernels.packet import SIZE
from . import port as ftdi
from .image import WHENCE
from .port import READ_BYTES, Port

log: logging.Logger = logging.getLogger(__name__)
TRIES = 10  # attempts to load; the first one often fails
GREETINGS, PROBES = 100, 10
HELLO, READY, AUTOBAUD = b"\x0aC\x0d", b"\x0aD,\x0d", b"A"
# Bytes sent at a time: with the chip's 2 status bytes, their echo fills a USB packet, which the chip sends at once.
CHUNK = 62
# Reads without a byte after which no more is expected; each lasts as long as the chip's latency timer.
QUIET = 64
NULL = b"<AAAAAAAAAAAAAA>"  # packet without torque, light and homing


class LoadError(Exception):
    """An attempt to load that failed and may be repeated."""


def open_running(opener: Callable[[], Port], image: bytes | None, event_character: bool = False) -> Port:
    """Open a port to a Falcon, with firmware loaded if needed, on a new port each time. Raises: DeviceError."""
    place, failure = "", LoadError("")
    for attempt in range(1, TRIES + 1):
        port = opener()
        try:
            _start(port, image, event_character)
            return port
        except LoadError as error:
            place, failure = port.place, error
            port.close()
        except BaseException:
            port.close()
            raise
        log.info("%s: attempt %d of %d to load its firmware failed: %s", place, attempt, TRIES, failure)
    raise DeviceError(
        f"{place}: its firmware cannot be loaded, {TRIES} attempts failed, the last because {failure}; "
        "unplug its power supply, wait for ten seconds, and try again"
    )


def _start(port: Port, image: bytes | None, event_character: bool) -> None:
    """Load the firmware unless it answers. Raises: LoadError, DeviceError as `open_running`."""
    ftdi.run_time(port, event_character)
    if firmware_answers(port):
        return
    if image is None:
        raise DeviceError(f"{port.place}: has no firmware since power-on; give the option firmware; {WHENCE}")
    load(port, image)
    ftdi.run_time(port, event_character)
    if not firmware_answers(port):
        raise LoadError("the firmware does not answer")


def firmware_answers(port: Port) -> bool:
    """Tell whether firmware is running: it answers a null packet."""
    chunk = array("B", bytes(READ_BYTES))
    begun, answer, counts = np.zeros(SIZE, np.uint8), np.zeros(SIZE, np.uint8), np.zeros(COUNTS, np.int64)
    for _ in range(PROBES):
        port.write(array("B", NULL))
        for _ in range(QUIET // PROBES):
            if receive(np.frombuffer(chunk, np.uint8), port.read(chunk), begun, counts, answer):
                return True
    return False


def load(port: Port, image: bytes) -> None:
    """Try to load once. Raises: LoadError if there is no boot loader or an echo differs, DeviceError if USB fails."""
    _boot_mode(port)
    _greet(port)
    port.request(ftdi.MODEM, 0x0100)
    port.request(ftdi.BAUD, ftdi.BAUD_142857)
    _send_echoed(port, AUTOBAUD)
    for at in range(0, len(image), CHUNK):
        _send_echoed(port, image[at : at + CHUNK])


def _boot_mode(port: Port) -> None:
    port.purge()
    for request, value in (
        (ftdi.LATENCY, 16),
        (ftdi.BAUD, ftdi.BAUD_9600),
        (ftdi.LINE, 0x0008),
        (ftdi.FLOW, 0),
        (ftdi.MODEM, 0x0200),  # RTS low
        (ftdi.MODEM, 0x0100),  # DTR low, then high: reset
        (ftdi.MODEM, 0x0101),
    ):
        port.request(request, value)


def _greet(port: Port) -> None:
    reply = b""
    for _ in range(GREETINGS):
        port.write(array("B", HELLO))
        reply = (reply + port.payload())[-USB_PACKET:]
        if READY in reply:
            return
    raise LoadError("the boot loader does not answer")


def _send_echoed(port: Port, data: bytes) -> None:
    port.write(array("B", data))
    echo, quiet = b"", 0
    while len(echo) < len(data) and quiet < QUIET:
        more = port.payload()
        echo, quiet = echo + more, 0 if more else quiet + 1
    if echo != data:
        raise LoadError(f"{len(data)} bytes came back as {len(echo)} others" if echo else "there was no echo")
