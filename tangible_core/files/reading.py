"""Limits on what a file may hold, checked before it is read and before it is decoded: the same for every reader."""

import errno
import math
import stat
from collections.abc import Sequence
from functools import lru_cache
from pathlib import Path

import xxhash

MAX_PIXELS = 89_000_000
"""The most pixels of a picture or an array in a file. A method may need a hundred bytes for each pixel."""
MAX_BYTES = 16 * MAX_PIXELS
"""The most bytes of a file, and of all its numbers once they are decoded: four channels of 32 bits a pixel."""
MAX_TEXT_BYTES = 250_000
"""The most bytes of a file that people write by hand; the time to parse YAML grows faster than its length."""
TOO_MANY_PIXELS = f"is larger than {MAX_PIXELS // 1_000_000} megapixels"

# The most bytes to read from a file whose size is given as 0; some files of Linux say so and have no end.
_UNKNOWN_SIZE = 1 << 16
_CHUNK = 1 << 20


class TooLargeError(ValueError):
    """A file holds, or its header announces, more than the limits allow."""


def check_size(shape: Sequence[int], itemsize: int) -> None:
    """Check the shape of an array that a header announces, pixels first. Raises: TooLargeError."""
    if len(shape) > 1 and math.prod(shape[:2]) > MAX_PIXELS:
        raise TooLargeError(TOO_MANY_PIXELS)
    check_bytes(math.prod(shape) * itemsize)


def check_bytes(count: int) -> None:
    """Check the number of bytes that several headers announce together. Raises: TooLargeError."""
    if count > MAX_BYTES:
        raise TooLargeError(f"holds more than {in_words(MAX_BYTES)}")


def check_file(path: Path, most: int = MAX_BYTES) -> None:
    """Check that a path leads to a regular file of at most this many bytes: a device may have no end."""
    try:
        state = path.stat()
    except ValueError as error:
        raise OSError(errno.EINVAL, "no file can have this name") from error
    if not stat.S_ISREG(state.st_mode):
        raise OSError(errno.EINVAL, "it is not a file but a folder or a device")
    if state.st_size > most:
        raise OSError(errno.EFBIG, f"it holds more than {in_words(most)}")


def read_bytes(path: Path, most: int = MAX_BYTES) -> bytes:
    """Read a whole file. Raises: OSError as `check_file`, or if it cannot be read."""
    check_file(path, most)
    with path.open("rb") as file:
        return file.read(max(path.stat().st_size, _UNKNOWN_SIZE))


def in_words(count: int) -> str:
    """Return a number of bytes as text.

    >>> in_words(MAX_BYTES), in_words(MAX_TEXT_BYTES)
    ('1424 MB', '0.25 MB')
    """
    return f"{count / 1e6:g} MB"


def content_digest(path: Path) -> str:
    """Return the XXH3-128 of a file's content; "" if the file does not exist or cannot be read."""
    try:
        state = path.stat()
        return _digest(path, state.st_mtime_ns, state.st_size, state.st_ino) if path.is_file() else ""
    except (OSError, ValueError):  # the reader of the file reports it; no file can have some names
        return ""


@lru_cache(maxsize=64)
def _digest(path: Path, changed_ns: int, size: int, inode: int) -> str:
    state = xxhash.xxh3_128()
    with path.open("rb") as file:
        while chunk := file.read(_CHUNK):
            state.update(chunk)
    return state.hexdigest()
