"""Memory that processes share by a name: files in memory, and on Windows sections of the paging file."""

import mmap
import os
import re
import secrets
import stat
import sys
import tempfile
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path

from .processes import is_alive

PREFIX = "tangible-"
NAME = re.compile(rf"{PREFIX}([0-9]{{1,9}})-\w+\.(ring|parcel)")


def shared_folder() -> Path:
    """Return $TANGIBLE_SHARED_DIR, or a folder in memory if the system has one, as a disk would stall the loop."""
    if folder := os.environ.get("TANGIBLE_SHARED_DIR"):
        return Path(folder)
    memory = Path("/dev/shm")
    return memory if sys.platform == "linux" and os.access(memory, os.W_OK) else Path(tempfile.gettempdir())


if sys.platform == "win32":
    import _winapi

    _HEAD = 64
    """Bytes before the memory itself: its size, and 1 once it is removed; a cache line."""
    _held: dict[str, mmap.mmap] = {}
    """Memory that this process keeps: Windows frees what nobody has mapped."""

    def create(kind: str, size: int, _later: int = 0) -> tuple[Path, memoryview]:
        """Make memory of zeros; return its name, and the memory. Raises: OSError if there is no room."""
        _let_go()
        name = f"{PREFIX}{os.getpid()}-{secrets.token_hex(4)}.{kind}"
        _held[name] = memory = mmap.mmap(-1, _HEAD + size, tagname=name)
        memory[:8] = size.to_bytes(8, "little")
        return Path(name), memoryview(memory)[_HEAD:]

    def write(kind: str, parts: Sequence[bytes | memoryview]) -> Path:
        """Make memory of these bytes, and return its name. Raises: OSError if there is no room."""
        path, memory = create(kind, sum(len(part) for part in parts))
        at = 0
        for part in parts:
            memory[at : at + len(part)] = part
            at += len(part)
        return path

    def attach(path: Path) -> memoryview:
        """Map the memory of this name. Raises: OSError if there is none any more."""
        memory = _map(path.name)
        return memoryview(memory)[_HEAD : _HEAD + int.from_bytes(memory[:8], "little")]

    def exists(path: Path) -> bool:
        """Return True if there is memory of this name."""
        try:
            _map(path.name)
        except OSError:
            return False
        return True

    def adopt(path: Path) -> Path:
        """Keep memory of another process, which may end or remove it from then on. Raises: OSError if it is gone."""
        _let_go()
        _held[path.name] = _map(path.name)
        return path

    def remove(path: Path) -> None:
        """Remove the name, if it exists; processes that have mapped the memory may go on using it."""
        with suppress(OSError):
            _map(path.name)[8] = 1
        _let_go()

    def make_room(path: Path, _start: int, _size: int) -> None:
        """Do nothing: the paging file has the room since the start. Raises: OSError if the memory is gone."""
        if not exists(path):
            raise FileNotFoundError(2, "removed", str(path))

    def delete_stale() -> None:
        """Do nothing: what ended processes leave is freed by the system."""

    def _map(name: str) -> mmap.mmap:
        handle = _winapi.OpenFileMapping(_winapi.FILE_MAP_READ, False, name)
        try:
            view = _winapi.MapViewOfFile(handle, _winapi.FILE_MAP_READ, 0, 0, 0)
            try:
                size = _winapi.VirtualQuerySize(view)
            finally:
                _winapi.UnmapViewOfFile(view)
            memory = mmap.mmap(-1, size, tagname=name)
        finally:
            _winapi.CloseHandle(handle)
        if memory[8]:
            raise FileNotFoundError(2, "removed", name)
        return memory

    def _let_go() -> None:
        """Let go of removed memory: the last process that has mapped it frees it."""
        for name in [name for name, memory in _held.items() if memory[8]]:
            del _held[name]

else:

    def create(kind: str, size: int, later: int = 0) -> tuple[Path, memoryview]:
        """Make memory of zeros; return its name, a file, and the memory.

        later: bytes at its end that get room by `make_room` only. Raises: OSError if there is no room.
        """
        path = _new(kind)
        try:
            with path.open("r+b") as file:
                file.truncate(size)
                _allocate(file.fileno(), 0, size - later)
                return path, memoryview(mmap.mmap(file.fileno(), 0))
        except OSError:
            path.unlink(missing_ok=True)
            raise

    def write(kind: str, parts: Sequence[bytes | memoryview]) -> Path:
        """Make memory of these bytes, and return its name, a file. Raises: OSError if there is no room."""
        path = _new(kind)
        try:
            with path.open("wb") as file:
                for part in parts:
                    file.write(part)
        except OSError:
            path.unlink(missing_ok=True)
            raise
        return path

    def attach(path: Path) -> memoryview:
        """Map the memory of this name. Raises: OSError or ValueError if there is none any more."""
        with path.open("r+b") as file:
            return memoryview(mmap.mmap(file.fileno(), 0))

    def exists(path: Path) -> bool:
        """Return True if there is memory of this name."""
        return path.exists()

    def adopt(path: Path) -> Path:
        """Name memory of another process after this one, and return the new name. Raises: OSError if it is gone."""
        return path.rename(path.with_name(re.sub(rf"^{PREFIX}[0-9]+", f"{PREFIX}{os.getpid()}", path.name)))

    def remove(path: Path) -> None:
        """Remove the name, if it exists; processes that have mapped the memory may go on using it."""
        path.unlink(missing_ok=True)

    def make_room(path: Path, start: int, size: int) -> None:
        """Give room to a part that `create` left for later. Raises: OSError if there is none, or the memory is gone."""
        with path.open("r+b") as file:
            _allocate(file.fileno(), start, size)

    def delete_stale() -> None:
        """Delete the memory of this user's killed processes, except files that cannot be examined or deleted."""
        with suppress(OSError):
            for path in shared_folder().glob(f"{PREFIX}*"):
                with suppress(OSError):
                    if _is_stale(path):
                        path.unlink()

    def _is_stale(path: Path) -> bool:
        """Return True for a file of `create` or `write` by a process of this user that is gone."""
        match = NAME.fullmatch(path.name)
        about = path.lstat()
        ours = about.st_uid == os.getuid() and stat.S_ISREG(about.st_mode)
        return bool(match and ours and not is_alive(int(match[1])))

    def _new(kind: str) -> Path:
        number, name = tempfile.mkstemp(f".{kind}", f"{PREFIX}{os.getpid()}-", shared_folder())
        os.close(number)
        return Path(name)

    def _allocate(number: int, start: int, size: int) -> None:
        """Allocate a part of a file in memory: where there is no room, a process that writes to it would be killed.

        Raises: OSError if there is no room.
        """
        if sys.platform != "darwin":  # macOS has no such call
            os.posix_fallocate(number, start, size)
