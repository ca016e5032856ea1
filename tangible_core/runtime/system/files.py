"""Files: locks, owners, times, and the reason why one cannot be written."""

import os
import sys
from collections.abc import Generator
from contextlib import contextmanager, suppress
from io import FileIO
from pathlib import Path

_IN_USE = {32, 33}  # ERROR_SHARING_VIOLATION and ERROR_LOCK_VIOLATION of Windows
_DENIED = 5  # ERROR_ACCESS_DENIED, with which Windows also refuses to replace a file that is open


def is_in_use(error: OSError, path: Path) -> bool:
    """Return True if Windows refused to write a file because another program has it open."""
    code = getattr(error, "winerror", None)
    return code in _IN_USE or (code == _DENIED and path.is_file() and os.access(path, os.W_OK))


if sys.platform == "win32":
    import ctypes
    import msvcrt

    BINARY = os.O_BINARY
    """The flag that makes `os.open` open a file as binary."""
    _PAST_END = 2**30
    """The upper 32 bits of the byte that is locked: others may not read a locked byte, and no file is so long."""

    def lock(file: FileIO) -> None:
        """Lock an open file until it is closed or this process ends. Raises: OSError if another process holds it."""
        handle = ctypes.c_void_p(msvcrt.get_osfhandle(file.fileno()))
        kernel = ctypes.WinDLL("kernel32", use_last_error=True)
        if not kernel.LockFile(handle, 0, _PAST_END, 1, 0):
            raise ctypes.WinError(ctypes.get_last_error())

    def take_lock(number: int) -> None:
        """Lock an open, empty file by its number. Raises: OSError if another process holds it."""
        msvcrt.locking(number, msvcrt.LK_NBLCK, 1)

    def wait_for_lock(_number: int) -> None:
        """Do nothing: a file that is being written cannot be deleted here anyway."""

    @contextmanager
    def folder_lock(folder: Path) -> Generator[None]:
        """Hold a folder's lock in this block while other processes wait, however long."""
        name = folder / ".alone"
        with FileIO(os.open(name, os.O_RDWR | os.O_CREAT | os.O_TEMPORARY), "r+") as file:
            while True:
                with suppress(OSError):  # after ten seconds LK_LOCK gives up
                    msvcrt.locking(file.fileno(), msvcrt.LK_LOCK, 1)
                    break
            yield

    @contextmanager
    def left_by_others(path: Path) -> Generator[None]:
        """Do nothing for a file, as one that is open cannot be deleted here. Raises: OSError for a folder."""
        if path.is_dir():
            raise OSError
        yield

    def is_mine(path: Path) -> bool:
        """Return True for a file or folder of this user; folders for temporary files are each user's own here."""
        return path.exists()

    def changed_ns(state: os.stat_result) -> int:
        """Return the time of the last change of a file's content, nanoseconds since 1970."""
        return state.st_mtime_ns

else:
    import fcntl

    BINARY = 0
    """The flag that makes `os.open` open a file as binary: each file is."""

    def lock(file: FileIO) -> None:
        """Lock an open file until it is closed or this process ends. Raises: OSError if another process holds it."""
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)

    def take_lock(number: int) -> None:
        """Lock an open, empty file by its number. Raises: OSError if another process holds it."""
        fcntl.flock(number, fcntl.LOCK_EX | fcntl.LOCK_NB)

    def wait_for_lock(number: int) -> None:
        """Lock an open file or folder until it is closed, where the file system can; wait while another holds it."""
        with suppress(OSError):
            fcntl.flock(number, fcntl.LOCK_EX)

    @contextmanager
    def folder_lock(folder: Path) -> Generator[None]:
        """Hold a folder's lock in this block while other processes wait; without locks, nobody waits."""
        number = os.open(folder, os.O_RDONLY)
        try:
            wait_for_lock(number)
            yield
        finally:
            os.close(number)

    @contextmanager
    def left_by_others(path: Path) -> Generator[None]:
        """Hold the lock of a file or folder in this block, to delete it. Raises: OSError if a process holds it."""
        number = os.open(path, os.O_RDONLY | os.O_NOFOLLOW)
        try:
            fcntl.flock(number, fcntl.LOCK_EX | fcntl.LOCK_NB)
            if not os.path.samestat(os.fstat(number), path.lstat()):
                raise FileNotFoundError(path)
            yield
        finally:
            os.close(number)

    def is_mine(path: Path) -> bool:
        """Return True for a file or folder of this user, not a link to one. Raises: OSError if it is gone."""
        return not path.is_symlink() and path.stat().st_uid == os.getuid()

    def changed_ns(state: os.stat_result) -> int:
        """Return the time of the last change of a file's content, nanoseconds since 1970."""
        return max(state.st_mtime_ns, state.st_ctime_ns)
