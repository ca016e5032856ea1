"""How much a file may hold, looked at before it is read and before it is decoded: one limit for every reader."""

import errno
import math
import stat
from collections.abc import Sequence
from functools import lru_cache
from pathlib import Path

import xxhash

MOST_PIXELS = 89_000_000
"""Of a picture or an array in a file. A method may take a hundred bytes for each of them."""
MOST_BYTES = 16 * MOST_PIXELS
"""Of all numbers in a file, once they are decoded, and of the file: four channels of 32 bits."""
MOST_TEXT_BYTES = 250_000
"""Of a file that somebody writes by hand; its parser takes longer than in proportion."""
TOO_MANY_PIXELS = f"is larger than {MOST_PIXELS // 1_000_000} megapixels"

_UNSAID = 1 << 16
_CHUNK = 1 << 20


class TooLargeError(ValueError):
    """A file holds, or says that it holds, more than is read."""


def check_size(shape: Sequence[int], itemsize: int) -> None:
    """What a header says of an array, pixels first. Raises: TooLargeError."""
    if len(shape) > 1 and math.prod(shape[:2]) > MOST_PIXELS:
        raise TooLargeError(TOO_MANY_PIXELS)
    check_bytes(math.prod(shape) * itemsize)


def check_bytes(count: int) -> None:
    """What several headers say together. Raises: TooLargeError."""
    if count > MOST_BYTES:
        raise TooLargeError(f"holds more than {in_words(MOST_BYTES)}")


def check_file(path: Path, most: int = MOST_BYTES) -> None:
    """Raises: OSError, its strerror in words, if there is none, it is a folder or a device, or holds more than that.

    A device or a pipe may have no end, or keep its reader waiting.
    """
    try:
        found = path.stat()
    except ValueError as error:
        raise OSError(errno.EINVAL, "no file can have this name") from error
    if not stat.S_ISREG(found.st_mode):
        raise OSError(errno.EINVAL, "it is not a file but a folder or a device")
    if found.st_size > most:
        raise OSError(errno.EFBIG, f"it holds more than {in_words(most)}")


def read_bytes(path: Path, most: int = MOST_BYTES) -> bytes:
    """The whole of a file. Raises: OSError as `check_file`, or if it cannot be read."""
    check_file(path, most)
    with path.open("rb") as file:
        return file.read(max(path.stat().st_size, _UNSAID))  # some of the system's files say 0, and have no end


def in_words(count: int) -> str:
    """A number of bytes.

    >>> in_words(MOST_BYTES), in_words(MOST_TEXT_BYTES)
    ('1424 MB', '0.25 MB')
    """
    return f"{count / 1e6:g} MB"


def content_digest(path: Path) -> str:
    """XXH3-128 of a file's content; empty where there is no such file, or it cannot be read.

    A file of the same size and the same time of its last change is not read again.
    """
    try:
        found = path.stat()
        return _digest(path, found.st_mtime_ns, found.st_size, found.st_ino) if path.is_file() else ""
    except OSError:  # whoever needs the file says it
        return ""


@lru_cache(maxsize=64)
def _digest(path: Path, changed_ns: int, size: int, inode: int) -> str:
    state = xxhash.xxh3_128()
    with path.open("rb") as file:
        while chunk := file.read(_CHUNK):
            state.update(chunk)
    return state.hexdigest()
