"""The processor of a simulated Falcon: its boot loader, then its firmware; bytes in, bytes out."""

import struct
from typing import Literal, final

from ..usb.image import RESERVED_WORDS
from .body import Body

Mode = Literal["idle", "monitor", "autobaud", "load", "run"]
HELLO, READY = b"\x0aC\x0d", b"\x0aD,\x0d"
SLOW, LOADING, FAST = 0x4138, 0x0015, 0x0002
"""Divisors of the chip's 3 MHz for the baud rates of the monitor, the loader and the firmware."""


@final
class Processor:
    """A processor with the states of TI's boot ROM: after a reset it greets, locks the rate, loads and runs code."""

    def __init__(self, body: Body, silent_greetings: int = 0) -> None:
        self.body = body
        self.mode: Mode = "idle"
        self._silent_greetings = silent_greetings
        self._input = b""

    def reset(self) -> None:
        """Reset, after DTR went low and high: firmware and torques are lost."""
        self.mode, self._input = "monitor", b""
        self.body.let_go()

    def unpower(self) -> None:
        """Lose power: return to the state before the first reset."""
        self.reset()
        self.mode = "idle"

    def hear(self, data: bytes, divisor: int, dtr: bool, now_s: float) -> bytes:
        """Return the reply to these bytes at this rate."""
        self._input += data
        if self.mode == "monitor" and divisor == SLOW and dtr:
            if HELLO not in self._input:
                return b""
            self._input = b""
            if self._silent_greetings:
                self._silent_greetings -= 1
                return b""
            self.mode = "autobaud"
            return READY
        if self.mode == "autobaud" and divisor == LOADING and not dtr:
            letters, self._input = self._input, b""
            if letters != b"A":
                return b""
            self.mode = "load"
            return b"A"
        if self.mode == "load" and divisor == LOADING:
            if stream_ends(self._input):
                self.mode, self._input = "run", b""
            return data
        if self.mode == "run" and divisor == FAST:
            return self._answer(now_s)
        self._input = b""  # noise at the wrong rate
        return b""

    def _answer(self, now_s: float) -> bytes:
        reply = b""
        while len(self._input) >= 16:
            if self._input[0] == 0x3C and self._input[15] == 0x3E:
                reply += self._obey(self._input[:16], now_s)
                self._input = self._input[16:]
            else:
                self._input = self._input[1:]
        return reply

    def _obey(self, packet: bytes, now_s: float) -> bytes:
        torques = tuple(signed_number(packet[at : at + 4]) for at in (1, 5, 9))
        self.body.obey(torques, packet[13] - 0x41 & 15, now_s)
        encoders, info = self.body.report()
        return b"<" + b"".join(map(digits, encoders)) + bytes([0x41 + info, 0x41]) + b">"


def signed_number(four: bytes) -> int:
    """Return the number of four digits, the least significant first."""
    value = sum((digit - 0x41 & 15) << 4 * place for place, digit in enumerate(four))
    return value - 0x10000 if value & 0x8000 else value


def digits(value: int) -> bytes:
    """Return the four digits of a number."""
    return bytes(0x41 + (value >> 4 * place & 15) for place in range(4))


def stream_ends(stream: bytes) -> bool:
    """Tell whether a boot stream is complete: its last block has length 0."""
    at = 2 * (1 + RESERVED_WORDS + 2)
    while at + 2 <= len(stream):
        (length,) = struct.unpack_from("<H", stream, at)
        if not length:
            return True
        at += 2 * (3 + length)
    return False
