"""What stands in a file, as a short text that another content does not have."""

from functools import lru_cache
from pathlib import Path

import xxhash

CHUNK = 1 << 20


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
        while chunk := file.read(CHUNK):
            state.update(chunk)
    return state.hexdigest()
