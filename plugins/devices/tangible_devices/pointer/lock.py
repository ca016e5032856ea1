"""A lock that the operating system lets go of when its holder dies."""

import os
import sys
from pathlib import Path
from typing import final


@final
class Lock:
    """An exclusive lock on a file; two in one process exclude each other too."""

    def __init__(self, path: Path) -> None:
        self._handle = os.open(path, os.O_RDWR | os.O_CREAT, 0o600)
        self._open = True

    def take(self) -> bool:
        """Try to get it; at once."""
        try:
            _take(self._handle)
        except OSError:
            return False
        return True

    def close(self) -> None:
        """Let go; a second call does nothing."""
        if self._open:
            self._open = False
            os.close(self._handle)


if sys.platform == "win32":

    def _take(handle: int) -> None:
        import msvcrt

        msvcrt.locking(handle, msvcrt.LK_NBLCK, 1)

else:

    def _take(handle: int) -> None:
        import fcntl

        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
