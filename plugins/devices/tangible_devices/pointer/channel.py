"""The memory that a pointer device and its client share: a file of 4 kB in the user's runtime folder, mapped by both.

It has words of 8 bytes in the machine's order. Each side writes its own block, and reads the other's:

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

The bits of `buttons` above the real buttons may carry a number of the client's. The device ignores them, the clutch of
a mapping reads its own button's bit alone, and they come back with the tick that used the sample, in the column
`buttons` of the ring and of a recording. Bits up to 30 are possible; recordings hold 32 bits with a sign.

A block that is read while it is written does not match its checksum, on every processor and in whatever order memory
becomes visible; it is then read again. Next to the file are two lock files, whose locks the operating system releases
when a device or a client ends: a killed process leaves nothing to clean up.
"""

import mmap
import os
import re
import struct
import time
import warnings
from pathlib import Path
from typing import final

from tangible_core.errors import DeviceError
from tangible_core.runtime.system import is_mine, take_lock

MAGIC, DEVICE_OPEN, CLIENT_OPEN = 0, 1, 2
SAMPLE, SAMPLE_WORDS = 16, 8
FORCE, FORCE_WORDS = 32, 4  # first word of each block, and its length in words without the checksum
MARK = b"TANGPTR1"
FILE_BYTES = 4096
START, FACTOR, MASK = 0xCBF29CE484222325, 0x9E3779B97F4A7C15, (1 << 64) - 1
"""Start value and factor of the checksum, and the mask of its 64 bits."""
# Reads of a block before it counts as torn; writing one takes well under a microsecond.
TRIES = 8


@final
class Lock:
    """An exclusive lock on a file, also between two in one process; the system releases it when its holder ends."""

    def __init__(self, path: Path) -> None:
        self._handle = os.open(path, os.O_RDWR | os.O_CREAT, 0o600)
        self._open = True

    def take(self) -> bool:
        """Try to take the lock, without waiting."""
        try:
            take_lock(self._handle)
        except OSError:
            return False
        return True

    def close(self) -> None:
        """Release the lock; a second call does nothing."""
        if self._open:
            self._open = False
            os.close(self._handle)


def checksum(words: tuple[int, ...]) -> int:
    """Return a multiplicative hash of 64-bit words, as the kernels compute it; no pair of changes cancels out."""
    total = START
    for word in words:
        total = (total ^ word) * FACTOR & MASK
        total ^= total >> 32
    return total


def unpack_block(block: bytes) -> tuple[int, tuple[float, ...]] | None:
    """Return the number and the values of a block; None if it is torn."""
    *words, expected_sum = struct.unpack(f"={len(block) // 8}Q", block)
    if checksum(tuple(words)) != expected_sum:
        return None
    return words[0], struct.unpack(f"={len(words) - 1}d", block[8:-8])


@final
class Channel:
    """The mapped file of a channel, and this side's lock on it."""

    def __init__(self, name: str, side: str) -> None:
        """side: "device", which creates the file, or "client". Raises: DeviceError."""
        self.path: Path = channel_path(name)
        self.lock: Lock = Lock(self.path.with_suffix(f".{side}"))
        if not any(self.lock.take() or time.sleep(0.01) for _ in range(5)):  # a test by `_lives` takes it briefly
            self.lock.close()
            raise DeviceError(f"pointer {name!r} has a {side} already ({self.path}); end it, or use another channel")
        try:
            self.memory: mmap.mmap = _map(self.path, side == "device")
        except (OSError, ValueError) as error:
            self.lock.close()
            raise DeviceError(f"pointer {name!r}: {self.path} cannot be used: {error}; is a device open?") from error

    def flag(self, word: int) -> bool:
        """Tell whether a word is set."""
        return self.memory[word * 8 : word * 8 + 8] != bytes(8)

    def set_flag(self, word: int, on: bool) -> None:
        """Set a word to 1 or 0."""
        self.memory[word * 8 : word * 8 + 8] = struct.pack("=Q", on)

    def put(self, start: int, number: int, values: tuple[float, ...]) -> None:
        """Write a block with its checksum."""
        block = struct.pack(f"=Q{len(values)}d", number & MASK, *values)
        block += struct.pack("=Q", checksum(struct.unpack(f"={len(values) + 1}Q", block)))
        self.memory[start * 8 : start * 8 + len(block)] = block

    def take(self, start: int, words: int) -> tuple[int, tuple[float, ...]] | None:
        """Read a block; None if it is written all the time, or was left half written."""
        for _ in range(TRIES):
            if block := unpack_block(self.memory[start * 8 : (start + words + 1) * 8]):
                return block
        return None

    def close(self) -> None:
        """Release the lock; a second call does nothing."""
        self.lock.close()


def channel_path(name: str) -> Path:
    """Return the path of a channel's file. Raises: DeviceError if the name is not a plain word."""
    if not re.fullmatch(r"[a-z0-9][a-z0-9-]{0,63}", name):
        raise DeviceError(f"channel {name!r}: write lower-case letters, digits and hyphens")
    return _runtime_folder() / f"{name}.pointer"


def device_is_open(name: str) -> bool:
    """Tell whether a device of this channel is open and its process lives, by its lock: the flag alone may be stale."""
    path = channel_path(name)
    if not path.exists() or path.read_bytes()[DEVICE_OPEN * 8 :][:8] in (b"", bytes(8)):
        return False
    return _lives(path, "device")


def client_is_there(name: str) -> bool:
    """Tell whether this channel has a client whose process lives."""
    return _lives(channel_path(name), "client")


def _lives(path: Path, side: str) -> bool:
    lock = Lock(path.with_suffix(f".{side}"))
    try:
        return not lock.take()
    finally:
        lock.close()


def _runtime_folder() -> Path:
    """Return $TANGIBLE_RUNTIME_DIR or the user's runtime folder. Raises: DeviceError if another user owns it."""
    if variable := os.environ.get("TANGIBLE_RUNTIME_DIR"):
        folder = Path(variable)
    else:
        from platformdirs import user_runtime_path

        with warnings.catch_warnings(action="ignore"):  # on servers without such a folder, one in /tmp is used
            folder = user_runtime_path("tangible-images")
    folder.mkdir(mode=0o700, parents=True, exist_ok=True)
    if not is_mine(folder):
        raise DeviceError(f"{folder}: belongs to another user; set TANGIBLE_RUNTIME_DIR to one of your folders")
    return folder


def _map(path: Path, make: bool) -> mmap.mmap:
    handle = os.open(path, os.O_RDWR | (os.O_CREAT if make else 0), 0o600)
    try:
        if make and os.fstat(handle).st_size < FILE_BYTES:
            os.truncate(handle, FILE_BYTES)
        return mmap.mmap(handle, FILE_BYTES)
    finally:
        os.close(handle)
