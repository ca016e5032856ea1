"""The memory that a pointer device and its client share: a file of 4 kB in the user's runtime folder, mapped by both.

Words of 8 bytes in the machine's order. Each side writes a block of its own, and reads the other's:

| word | what | type | written by |
|---|---|---|---|
| 0 | `TANGPTR1` | 8 letters | device |
| 1 | 1 while the device is open | uint64 | device |
| 2 | 1 while a client holds the pointer | uint64 | client |
| 16 | number of this sample, counting up | uint64 | client |
| 17..19, 20..22 | position, metres; velocity, metres per second | float64 | client |
| 23 | buttons, one bit each | float64 | client |
| 24 | checksum of words 16..23 | uint64 | client |
| 32 | number of this force, counting up | uint64 | device |
| 33..35 | force on the hand, newtons | float64 | device |
| 36 | checksum of words 32..35 | uint64 | device |

Of the buttons, bits above those that are a button's may carry a number of the client's own: nothing here looks at them,
a mapping's clutch looks at its button's bit alone, and they come back with the tick that used the sample, in the ring's
and a recording's column `buttons`. Bits up to 30 do in each of them; recordings hold 32 with a sign.

A block that is read while it is written does not have its checksum, on every processor and whatever the order in which
memory becomes visible; it is then read again. Beside the file lie two locks, held by the operating system for as long
as a device or a client lives: a killed one leaves nothing behind that must be cleared away.
"""

import mmap
import os
import re
import struct
import sys
import time
import warnings
from pathlib import Path
from typing import final

from tangible_core.errors import DeviceError

from .lock import Lock

MAGIC, DEVICE_OPEN, CLIENT_OPEN = 0, 1, 2
SAMPLE, SAMPLE_WORDS = 16, 8
FORCE, FORCE_WORDS = 32, 4
"""Where the blocks begin, and how long they are without their checksums."""
MARK = b"TANGPTR1"
FILE_BYTES = 4096
START, FACTOR, MASK = 0xCBF29CE484222325, 0x9E3779B97F4A7C15, (1 << 64) - 1
"""Of the checksum."""
TRIES = 8
"""How often a block is read before it is given up as torn; a writer takes well under a microsecond."""


def checksum(words: tuple[int, ...]) -> int:
    """A multiplicative hash of 64-bit words, as the kernels compute it; no pair of changed words cancels out."""
    total = START
    for word in words:
        total = (total ^ word) * FACTOR & MASK
        total ^= total >> 32
    return total


def packed(number: int, values: tuple[float, ...]) -> bytes:
    """A block with its checksum."""
    body = struct.pack(f"=Q{len(values)}d", number & MASK, *values)
    return body + struct.pack("=Q", checksum(struct.unpack(f"={len(values) + 1}Q", body)))


def unpacked(block: bytes) -> tuple[int, tuple[float, ...]] | None:
    """The number and the values of a block; None if it is torn."""
    *words, claimed = struct.unpack(f"={len(block) // 8}Q", block)
    if checksum(tuple(words)) != claimed:
        return None
    return words[0], struct.unpack(f"={len(words) - 1}d", block[8:-8])


@final
class Channel:
    """The mapped file of one name, and this side's lock on it."""

    def __init__(self, name: str, side: str) -> None:
        """side: "device", which makes the file, or "client".

        Raises: DeviceError if the name is none, the side is taken, or the file cannot be made or is not there.
        """
        self.path = channel_path(name)
        self.lock = Lock(self.path.with_suffix(f".{side}"))
        if not any(self.lock.take() or time.sleep(0.01) for _ in range(5)):  # somebody may just be asking for it
            self.lock.close()
            raise DeviceError(f"pointer {name!r} has a {side} already ({self.path}); end it, or use another channel")
        try:
            self.memory = _mapped(self.path, side == "device")
        except (OSError, ValueError) as error:
            self.lock.close()
            raise DeviceError(f"pointer {name!r}: {self.path} cannot be used: {error}; is a device open?") from error

    def flag(self, word: int) -> bool:
        """Whether a word is set."""
        return self.memory[word * 8 : word * 8 + 8] != bytes(8)

    def set_flag(self, word: int, on: bool) -> None:
        """Set a word to 1 or 0."""
        self.memory[word * 8 : word * 8 + 8] = struct.pack("=Q", on)

    def put(self, start: int, number: int, values: tuple[float, ...]) -> None:
        """Write a block."""
        block = packed(number, values)
        self.memory[start * 8 : start * 8 + len(block)] = block

    def take(self, start: int, words: int) -> tuple[int, tuple[float, ...]] | None:
        """Read a block; None if it is being written all the time, or was left half written."""
        for _ in range(TRIES):
            if block := unpacked(self.memory[start * 8 : (start + words + 1) * 8]):
                return block
        return None

    def close(self) -> None:
        """Let go; a second call does nothing."""
        self.lock.close()


def channel_path(name: str) -> Path:
    """Where a channel's file lies. Raises: DeviceError if the name is no plain word."""
    if not re.fullmatch(r"[a-z0-9][a-z0-9-]{0,63}", name):
        raise DeviceError(f"channel {name!r}: write lower-case letters, digits and hyphens")
    return _runtime_folder() / f"{name}.pointer"


def device_is_open(name: str) -> bool:
    """Whether a device of this channel is ready, and lives: what it wrote may be older than it, its lock may not."""
    path = channel_path(name)
    if not path.exists() or path.read_bytes()[DEVICE_OPEN * 8 :][:8] in (b"", bytes(8)):
        return False
    return _lives(path, "device")


def client_is_there(name: str) -> bool:
    """Whether somebody has the client's place on this channel, and lives."""
    return _lives(channel_path(name), "client")


def _lives(path: Path, side: str) -> bool:
    lock = Lock(path.with_suffix(f".{side}"))
    try:
        return not lock.take()
    finally:
        lock.close()


def _runtime_folder() -> Path:
    """$TANGIBLE_RUNTIME_DIR, or the user's runtime folder. Raises: DeviceError if it is somebody else's."""
    if named := os.environ.get("TANGIBLE_RUNTIME_DIR"):
        folder = Path(named)
    else:
        from platformdirs import user_runtime_path

        with warnings.catch_warnings(action="ignore"):  # that a server has no such folder, and one in /tmp is used
            folder = user_runtime_path("tangible-images")
    folder.mkdir(mode=0o700, parents=True, exist_ok=True)
    if sys.platform != "win32" and folder.stat().st_uid != os.getuid():
        raise DeviceError(f"{folder}: belongs to another user; set TANGIBLE_RUNTIME_DIR to a folder of your own")
    return folder


def _mapped(path: Path, make: bool) -> mmap.mmap:
    handle = os.open(path, os.O_RDWR | (os.O_CREAT if make else 0), 0o600)
    try:
        if make and os.fstat(handle).st_size < FILE_BYTES:
            os.truncate(handle, FILE_BYTES)
        return mmap.mmap(handle, FILE_BYTES)
    finally:
        os.close(handle)
